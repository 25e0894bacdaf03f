#include "core/scene/builder.h"

#include <glm/glm.hpp>

#include <cmath>

namespace lampyris {
namespace {

TextureProgram make(TextureContext& context) {
    glm::dvec3 direction(0.0, 1.0, 0.0);
    if (const std::vector<float> given = context.reader.get_tuple("dir", 3); given.size() == 3)
        direction = {given[0], given[1], given[2]};
    direction = glm::dmat3(glm::dmat4(context.texture.world_from_texture.matrix[0])) * direction;
    const double length = glm::length(direction);
    if (!(length > 0.0) || !std::isfinite(length)) {
        context.reader.error("dir", "\"dir\" is no direction", "three numbers that are not all zero");
        return constant_program(glm::vec3(0.5f));
    }
    kernel::TextureOp op{};
    op.operation = kernel::TEXTURE_DIRECTION_MIX;
    op.a = glm::vec4(glm::vec3(direction / length), 0.0f);
    return context.combine({context.operand("tex1", 0.0f), context.operand("tex2", 1.0f)}, op);
}

const RegisterTexture registration(
    "directionmix",
    "tex1 where the surface faces a direction, or away from it; tex2 where the surface is parallel to it: the weight "
    "of "
    "tex1 is |cos|.",
    {value("tex1", ParameterType::kSpectrum, "0", "of surfaces that face the direction; in a float texture, a float")
         .textured(),
     value("tex2", ParameterType::kSpectrum, "1", "of surfaces that are parallel to it").textured(),
     value("dir", ParameterType::kVector3, "0 1 0", "the direction")},
    make);

}  // namespace
}  // namespace lampyris

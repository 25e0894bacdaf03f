#include "core/scene/texture_builder.h"

namespace lampyris {
namespace {

const RegisterTexture registration(
    "scale", "The product of two textures.",
    {value("tex", ParameterType::kSpectrum, "1", "the texture to be scaled; in a float texture, a float").textured(),
     real("scale", 1.0, "its factor").textured()},
    [](TextureContext& context) {
        kernel::TextureOp op{};
        op.operation = kernel::TEXTURE_SCALE;
        return context.combine({context.operand("tex", 1.0f), context.float_operand("scale", 1.0f)}, op);
    });

}  // namespace
}  // namespace lampyris

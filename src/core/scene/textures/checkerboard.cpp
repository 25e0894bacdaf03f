#include "core/scene/builder.h"

#include <fmt/format.h>

namespace lampyris {
namespace {

TextureProgram make(TextureContext& context) {
    kernel::TextureOp op{};
    op.operation = kernel::TEXTURE_CHECKERBOARD;
    if (context.reader.get_int("dimension") == 3)
        context.read_position_mapping(op);
    else
        context.read_mapping(op);
    return context.combine({context.operand("tex1", 1.0f), context.operand("tex2", 0.0f)}, op);
}

const RegisterTexture registration(
    "checkerboard", "Two textures that alternate in unit squares of (s, t) or unit cubes of space.",
    with_mapping({integer("dimension", 2, "2: squares of the mapping; 3: cubes in the texture's space").between(2, 3),
                  value("tex1", ParameterType::kSpectrum, "1",
                        "in cells whose coordinates add up to an even number; in a float texture, a float")
                      .textured(),
                  value("tex2", ParameterType::kSpectrum, "0", "in the others").textured()}),
    make);

}  // namespace
}  // namespace lampyris

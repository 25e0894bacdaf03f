#include "core/scene/texture_builder.h"

namespace lampyris {
namespace {

// pbrt-v4 hands its two textures to the constructor in the wrong order, so that `inside` shows outside of the dots
// there; here the names mean what pbrt's documentation says.
const RegisterTexture registration(
    "dots", "Dots of one texture, scattered at random over half of the unit cells of (s, t), on another.",
    with_mapping({value("inside", ParameterType::kSpectrum, "1", "in the dots; in a float texture, a float").textured(),
                  value("outside", ParameterType::kSpectrum, "0", "between them").textured()}),
    [](TextureContext& context) {
        kernel::TextureOp op{};
        op.operation = kernel::TEXTURE_DOTS;
        context.read_mapping(op);
        return context.combine({context.operand("inside", 1.0f), context.operand("outside", 0.0f)}, op);
    });

}  // namespace
}  // namespace lampyris

#include "core/scene/texture_builder.h"

namespace lampyris {
namespace {

const RegisterTexture registration(
    "constant", "The same value everywhere.",
    {value("value", ParameterType::kSpectrum, "1", "the value; in a float texture, a float").textured()},
    [](TextureContext& context) { return context.operand("value", 1.0f); });

}  // namespace
}  // namespace lampyris

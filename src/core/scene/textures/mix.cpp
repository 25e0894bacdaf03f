#include "core/scene/texture_builder.h"

namespace lampyris {
namespace {

const RegisterTexture registration(
    "mix", "One texture blended into another: (1 - amount) tex1 + amount tex2.",
    {value("tex1", ParameterType::kSpectrum, "0", "shown where the amount is 0; in a float texture, a float")
         .textured(),
     value("tex2", ParameterType::kSpectrum, "1", "shown where the amount is 1").textured(),
     real("amount", 0.5, "share of tex2").textured()},
    [](TextureContext& context) {
        kernel::TextureOp op{};
        op.operation = kernel::TEXTURE_MIX;
        return context.combine(
            {context.operand("tex1", 0.0f), context.operand("tex2", 1.0f), context.float_operand("amount", 0.5f)}, op);
    });

}  // namespace
}  // namespace lampyris

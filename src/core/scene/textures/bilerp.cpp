#include "core/scene/texture_builder.h"

namespace lampyris {
namespace {

const RegisterTexture registration(
    "bilerp", "Four values at the corners of the unit square of (s, t), and what lies between them.",
    with_mapping({value("v00", ParameterType::kSpectrum, "0", "at (0, 0); in a float texture, a float"),
                  value("v01", ParameterType::kSpectrum, "1", "at (0, 1)"),
                  value("v10", ParameterType::kSpectrum, "0", "at (1, 0)"),
                  value("v11", ParameterType::kSpectrum, "1", "at (1, 1)")}),
    [](TextureContext& context) {
        kernel::TextureOp op{};
        op.operation = kernel::TEXTURE_BILERP;
        context.read_mapping(op);
        return context.combine({context.operand("v00", 0.0f), context.operand("v01", 1.0f),
                                context.operand("v10", 0.0f), context.operand("v11", 1.0f)},
                               op);
    });

}  // namespace
}  // namespace lampyris

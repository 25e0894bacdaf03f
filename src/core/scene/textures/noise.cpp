// Textures made of gradient noise in space.
#include "core/scene/builder.h"

#include <fmt/format.h>

namespace lampyris {
namespace {

TextureProgram program_of(TextureContext& context, uint32_t kind, bool is_spectrum) {
    if (context.texture.is_spectrum != is_spectrum) {
        context.reader.diagnostics().error(
            context.texture.type_location,
            fmt::format("texture \"{}\" is a {} texture", context.texture.type, is_spectrum ? "spectrum" : "float"),
            fmt::format("write Texture \"{}\" \"{}\" \"{}\"", shown(context.texture.name),
                        is_spectrum ? "spectrum" : "float", context.texture.type));
    }
    TextureProgram program = constant_program(glm::vec3(0.0f));
    kernel::TextureOp& op = program.ops[0];
    op.operation = kind;
    context.read_position_mapping(op);
    op.option = 6;  // of windy's waves
    if (kind == kernel::TEXTURE_WINDY) return program;
    op.option = uint32_t(context.reader.get_int("octaves"));
    op.a.x = context.reader.get_float("roughness");
    if (kind == kernel::TEXTURE_MARBLE) {
        op.a.y = context.reader.get_float("scale");
        op.a.z = context.reader.get_float("variation");
    }
    return program;
}

ParameterSpecs octave_specs() {
    return {integer("octaves", 8, "octaves of noise that are added up").between(1, 32),
            real("roughness", 0.5, "strength of an octave relative to the one before")};
}
ParameterSpecs marble_specs() {
    ParameterSpecs specs = octave_specs();
    specs.push_back(real("scale", 1.0, "of the texture's space"));
    specs.push_back(real("variation", 0.2, "how far noise bends the veins"));
    return specs;
}

const RegisterTexture fbm("fbm", "Fractional Brownian motion: octaves of noise.", octave_specs(),
                          [](TextureContext& context) { return program_of(context, kernel::TEXTURE_FBM, false); });
const RegisterTexture wrinkled("wrinkled", "Turbulence: octaves of the absolute value of noise.", octave_specs(),
                               [](TextureContext& context) {
                                   return program_of(context, kernel::TEXTURE_WRINKLED, false);
                               });
const RegisterTexture windy("windy", "Waves on water, higher where a gust of wind is.", {},
                            [](TextureContext& context) { return program_of(context, kernel::TEXTURE_WINDY, false); });
const RegisterTexture marble("marble", "Veins of marble.", marble_specs(),
                             [](TextureContext& context) { return program_of(context, kernel::TEXTURE_MARBLE, true); });

}  // namespace
}  // namespace lampyris

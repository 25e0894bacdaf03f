#include "core/scene/texture_plugin.h"

#include "core/scene/builder.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>

namespace lampyris {

namespace {

constexpr const char* kMappings[] = {"uv", "spherical", "cylindrical",
                                     "planar"};  // in order of kernel::MAPPING_*, from MAPPING_UV on

// Texture-from-world; if the current transform cannot be inverted, the identity, and an error is reported.
glm::dmat4 texture_from_world(const TextureContext& context) {
    const glm::dmat4 to(context.texture.world_from_texture.matrix[0]);
    const double determinant = glm::determinant(glm::dmat3(to));
    if (std::isfinite(determinant) && determinant != 0.0) return glm::inverse(to);
    context.reader.diagnostics().error(context.texture.location, "the transform in force here cannot be inverted",
                                       "the texture's mapping needs it");
    return glm::dmat4(1.0);
}

glm::vec4 row(const glm::dmat4& m, int i) { return {float(m[0][i]), float(m[1][i]), float(m[2][i]), float(m[3][i])}; }

// s = delta + dot(axis, texture-space position), as a row vector applied to the world-space position.
glm::vec4 planar_row(const TextureContext& context, const glm::dmat4& m, const char* name, glm::dvec3 axis,
                     float delta) {
    if (const std::vector<float> given = context.reader.get_tuple(name, 3); given.size() == 3)
        axis = {given[0], given[1], given[2]};
    const glm::dvec4 result = glm::transpose(m) * glm::dvec4(axis, 0.0);
    return {float(result.x), float(result.y), float(result.z), float(result.w + double(delta))};
}

}  // namespace

TextureProgram constant_program(glm::vec3 value) {
    kernel::TextureOp op{};
    op.operation = kernel::TEXTURE_CONSTANT;
    op.a = glm::vec4(value, 0.0f);
    TextureProgram program;
    program.ops.push_back(op);
    return program;
}

TextureProgram TextureContext::operand(std::string_view name, float absent) {
    return builder.operand(reader, name, absent, texture.is_spectrum);
}

TextureProgram TextureContext::float_operand(std::string_view name, float absent) {
    return builder.operand(reader, name, absent, false);
}

TextureProgram TextureContext::combine(const std::vector<TextureProgram>& operands, const kernel::TextureOp& op) {
    // Constant operands are combined here, so that this is not computed at every hit.
    const bool all_constant =
        std::all_of(operands.begin(), operands.end(), [](const TextureProgram& p) { return p.is_constant(); });
    if (op.operation == kernel::TEXTURE_SCALE && all_constant)
        return constant_program(operands[0].constant() * operands[1].constant());
    if (op.operation == kernel::TEXTURE_MIX && all_constant) {
        const float amount = operands[2].constant().x;
        return constant_program((1.0f - amount) * operands[0].constant() + amount * operands[1].constant());
    }
    if (op.operation == kernel::TEXTURE_SCALE) {
        for (int i = 0; i < 2; ++i) {
            const TextureProgram& image = operands[size_t(i)];
            const TextureProgram& scale = operands[size_t(1 - i)];
            if (!scale.is_constant() || image.ops.size() != 1 || image.ops[0].operation != kernel::TEXTURE_IMAGE ||
                (image.ops[0].option & 1u))
                continue;
            TextureProgram scaled = image;
            scaled.ops[0].a = glm::vec4(glm::vec3(scaled.ops[0].a) * scale.constant(), 0.0f);
            return scaled;
        }
    }
    TextureProgram result;
    result.depth = 0;
    size_t length = 1;
    for (size_t i = 0; i < operands.size(); ++i) {
        length += operands[i].ops.size();
        result.depth = std::max(result.depth, operands[i].depth + uint32_t(i));
    }
    if (length > kernel::TEXTURE_LENGTH || result.depth > kernel::TEXTURE_STACK) {
        reader.diagnostics().error(
            texture.location,
            fmt::format("texture \"{}\" with the textures that it is made of has {} operations and nests {} deep",
                        shown(texture.name), length, result.depth),
            fmt::format("at most {} operations, {} deep, are evaluated", kernel::TEXTURE_LENGTH,
                        kernel::TEXTURE_STACK));
        return constant_program(glm::vec3(0.5f));
    }
    result.ops.reserve(length);
    for (const TextureProgram& operand : operands)
        result.ops.insert(result.ops.end(), operand.ops.begin(), operand.ops.end());
    result.ops.push_back(op);
    return result;
}

void TextureContext::read_mapping(kernel::TextureOp& op) {
    const std::string mapping = reader.get_string("mapping");
    uint32_t kind = kernel::MAPPING_UV;
    for (uint32_t i = 0; i < std::size(kMappings); ++i)
        if (mapping == kMappings[i]) kind = kernel::MAPPING_UV + i;
    if (kind == kernel::MAPPING_UV) {
        op.flags |= kind << 8;
        op.m0.x = reader.get_float("uscale");
        op.m0.y = reader.get_float("vscale");
        op.m0.z = reader.get_float("udelta");
        op.m0.w = reader.get_float("vdelta");
        return;
    }
    if (kind == kernel::MAPPING_PLANAR) {
        op.flags |= kind << 8;
        const glm::dmat4 m = texture_from_world(*this);
        op.m0 = planar_row(*this, m, "v1", {1.0, 0.0, 0.0}, reader.get_float("udelta"));
        op.m1 = planar_row(*this, m, "v2", {0.0, 1.0, 0.0}, reader.get_float("vdelta"));
        return;
    }
    read_transform(op, kind);
}

void TextureContext::read_position_mapping(kernel::TextureOp& op) { read_transform(op, kernel::MAPPING_SPACE); }

void TextureContext::read_transform(kernel::TextureOp& op, uint32_t mapping) {
    op.flags |= mapping << 8;
    const glm::dmat4 m = texture_from_world(*this);
    op.m0 = row(m, 0);
    op.m1 = row(m, 1);
    op.m2 = row(m, 2);
}

ParameterSpecs with_mapping(ParameterSpecs specs) {
    specs.push_back(text("mapping", "uv", "how points of a surface map to (s, t)")
                        .one_of({kMappings[0], kMappings[1], kMappings[2], kMappings[3]}));
    specs.push_back(real("uscale", 1.0, "repetitions along u (uv mapping)"));
    specs.push_back(real("vscale", 1.0, "repetitions along v (uv mapping)"));
    specs.push_back(real("udelta", 0.0, "added to s (uv and planar mapping)"));
    specs.push_back(real("vdelta", 0.0, "added to t (uv and planar mapping)"));
    specs.push_back(value("v1", ParameterType::kVector3, "1 0 0", "planar mapping: s = dot(v1, p) + udelta"));
    specs.push_back(value("v2", ParameterType::kVector3, "0 1 0", "planar mapping: t = dot(v2, p) + vdelta"));
    return specs;
}

Registry<TextureFactory>& texture_registry() {
    static Registry<TextureFactory> registry(
        "texture", "Values that vary over a surface: `Texture \"NAME\" \"float|spectrum\" \"name\"`.");
    return registry;
}

RegisterTexture::RegisterTexture(const char* name, const char* summary, ParameterSpecs specs, TextureFactory factory) {
    texture_registry().add({name, summary, std::move(specs)}, factory);
}

}  // namespace lampyris

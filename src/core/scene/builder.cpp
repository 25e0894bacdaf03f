#include "core/scene/builder.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <cmath>
#include <filesystem>

namespace lampyris {

std::string Asker::operator()() const {
    return fmt::format("{} ({} \"{}\")",
                       entity->given() ? build->description.sources->describe(entity->location) : "default", directive,
                       entity->type);
}

std::string BuildContext::resolve(const std::string& filename) const { return description.folder.path(filename); }

kernel::TransformRecord transform_record(const glm::mat4& to) {
    // In double: the inverse's rounding would otherwise move quadrics against their neighbours.
    const glm::mat4 from(glm::inverse(glm::dmat4(to)));
    const auto row = [](const glm::mat4& m, int i) { return kernel::vec4(m[0][i], m[1][i], m[2][i], m[3][i]); };
    return {row(to, 0), row(to, 1), row(to, 2), row(from, 0), row(from, 1), row(from, 2)};
}

bool invertible(const glm::mat4& to) {
    const double determinant = glm::determinant(glm::dmat3(glm::mat3(to)));
    if (!std::isfinite(determinant) || determinant == 0.0) return false;
    const glm::mat4 from(glm::inverse(glm::dmat4(to)));
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k)
            if (!std::isfinite(to[i][k]) || !std::isfinite(from[i][k])) return false;
    return true;
}

bool swaps_handedness(const glm::mat4& m) { return glm::determinant(glm::dmat3(glm::mat3(m))) < 0.0; }

uint32_t BuildContext::add_transform(const glm::mat4& to, Location where) {
    if (!invertible(to)) {
        diagnostics.error(where, "the transform in force here cannot be inverted",
                          "a scale by 0, or numbers out of range?");
        scene.transforms.push_back(transform_record(glm::mat4(1.0f)));
    } else {
        scene.transforms.push_back(transform_record(to));
    }
    return uint32_t(scene.transforms.size() - 1);
}

void BuildContext::refuse_motion(const AnimatedTransform& transform, Location where) {
    if (transform.animated())
        diagnostics.unsupported(where, "motion blur (an animated transform)",
                                "--skip-unsupported uses the transform at the start");
}

namespace {

Spectrum value_of(BuildContext& context, const Parameter& parameter, SpectrumUse use, Spectrum default_value) {
    const std::optional<glm::vec3> rgb = spectrum_rgb(parameter, use, context.description.folder, context.diagnostics);
    return rgb ? spectrum_of_rgb(*rgb) : default_value;
}

// The name of the texture that a parameter refers to, or nothing.
const std::string* texture_name(const Parameter& parameter, BuildContext& context) {
    const auto* names = std::get_if<std::vector<std::string>>(&parameter.values);
    if (names && names->size() == 1) {
        context.ask(kernel::EFFECT_TEXTURES, [&] {
            return fmt::format("{} (\"texture {}\")", context.description.sources->describe(parameter.location),
                               parameter.name);
        });
        return &names->front();
    }
    context.diagnostics.error(parameter.location, fmt::format("\"{}\" must name one texture", parameter.name));
    return nullptr;
}

}  // namespace

Spectrum read_spectrum(BuildContext& context, ParameterReader& reader, std::string_view name, SpectrumUse use,
                       Spectrum default_value) {
    const Parameter* parameter = reader.find(name);
    return parameter ? value_of(context, *parameter, use, default_value) : default_value;
}

ColorSlot read_color(BuildContext& context, ParameterReader& reader, std::string_view name, SpectrumUse use,
                     Spectrum default_value) {
    ColorSlot slot;
    slot.value = default_value;
    const Parameter* parameter = reader.find(name);
    if (!parameter) return slot;
    slot.given = true;
    if (parameter->type == ParameterType::kTexture) {
        if (const std::string* texture = texture_name(*parameter, context))
            slot.texture = context.textures.color_program(*texture, parameter->value_location);
    } else {
        slot.value = value_of(context, *parameter, use, default_value);
    }
    return slot;
}

FloatSlot read_float(BuildContext& context, ParameterReader& reader, std::string_view name) {
    FloatSlot slot;
    slot.given = reader.has(name);
    const Parameter* parameter = reader.find(name);
    if (parameter && parameter->type == ParameterType::kTexture) {
        slot.value = float(find_spec(reader.specs(), name)->number);
        if (const std::string* texture = texture_name(*parameter, context))
            slot.texture = context.textures.float_program(*texture, parameter->value_location);
    } else {
        slot.value = reader.get_float(name);
    }
    return slot;
}

// ---- Registries ------------------------------------------------------------------------------------------------------

Registry<ShapeFactory>& shape_registry() {
    static Registry<ShapeFactory> registry("shape", "Surfaces: `Shape \"name\"`.");
    return registry;
}
Registry<MaterialFactory>& material_registry() {
    static Registry<MaterialFactory> registry("material",
                                              "How surfaces scatter light: `Material \"name\"`, `MakeNamedMaterial`.");
    return registry;
}
Registry<MediumFactory>& medium_registry() {
    static Registry<MediumFactory> registry("medium",
                                            "What fills space: `MakeNamedMedium \"name\"`, `MediumInterface`.");
    return registry;
}
Registry<LightFactory>& light_registry() {
    static Registry<LightFactory> registry("light",
                                           "Sources of light: `LightSource \"name\"`; area lights: `AreaLightSource`.");
    return registry;
}
Registry<CameraFactory>& camera_registry() {
    static Registry<CameraFactory> registry("camera", "Projections: `Camera \"name\"`.");
    return registry;
}
Registry<FilterFactory>& filter_registry() {
    static Registry<FilterFactory> registry("filter", "Pixel filters: `PixelFilter \"name\"`.");
    return registry;
}

RegisterShape::RegisterShape(const char* name, const char* summary, ParameterSpecs specs, ShapeFactory factory) {
    specs.push_back(
        real("alpha", 1.0, "share of the surface that is there; 0 lets every ray pass").between(0, 1).textured());
    shape_registry().add({name, summary, std::move(specs)}, factory);
}
RegisterMaterial::RegisterMaterial(const char* name, const char* summary, ParameterSpecs specs,
                                   MaterialFactory factory) {
    material_registry().add({name, summary, std::move(specs)}, factory);
}
RegisterMedium::RegisterMedium(const char* name, const char* summary, ParameterSpecs specs, MediumFactory factory) {
    medium_registry().add({name, summary, std::move(specs)}, factory);
}
RegisterLight::RegisterLight(const char* name, const char* summary, ParameterSpecs specs, LightFactory factory) {
    light_registry().add({name, summary, std::move(specs)}, factory);
}
RegisterCamera::RegisterCamera(const char* name, const char* summary, ParameterSpecs specs, CameraFactory factory) {
    camera_registry().add({name, summary, std::move(specs)}, factory);
}
RegisterFilter::RegisterFilter(const char* name, const char* summary, ParameterSpecs specs, FilterFactory factory) {
    filter_registry().add({name, summary, std::move(specs)}, factory);
}

}  // namespace lampyris

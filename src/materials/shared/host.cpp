#include "materials/shared/host.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>

namespace lampyris {

ParameterSpecs with_surface_detail(ParameterSpecs specs) {
    specs.push_back(
        value("displacement", ParameterType::kTexture, "none", "height of a bump map, which tilts the shading normal")
            .in("scene units"));
    specs.push_back(text("normalmap", "", "an image of shading normals in tangent space"));
    return specs;
}

void read_surface_detail(MaterialContext& context) {
    context.record.bump_texture = kernel::NONE;
    context.record.normal_map = kernel::NONE;
    if (const Parameter* bump = context.reader.find("displacement")) {
        const auto* names = std::get_if<std::vector<std::string>>(&bump->values);
        if (bump->type != ParameterType::kTexture || !names || names->size() != 1) {
            context.reader.error("displacement", "\"displacement\" must name one float texture",
                                 "\"texture displacement\" \"name\"");
        } else {
            context.record.bump_texture = context.build.textures.float_program(names->front(), bump->value_location);
            context.ask(kernel::EFFECT_TEXTURES);
            context.ask(kernel::EFFECT_BUMP);
        }
    }
    const std::string map = context.reader.get_string("normalmap");
    if (!map.empty()) {
        context.record.normal_map = context.build.textures.image(map, TextureBuilder::Content::kNormalMap,
                                                                 context.reader.location("normalmap"));
        context.ask(kernel::EFFECT_BUMP);
        context.ask(kernel::EFFECT_IMAGES);
    }
}

void add_roughness(ParameterSpecs& specs, const std::string& prefix, double default_value, const std::string& of_what) {
    specs.push_back(
        real(prefix + "roughness", default_value, "of " + of_what + "; 0 is a mirror").at_least(0).textured());
    specs.push_back(real(prefix + "uroughness", default_value, "along u; default: roughness").at_least(0).textured());
    specs.push_back(real(prefix + "vroughness", default_value, "along v; default: roughness").at_least(0).textured());
}

Roughness read_roughness(MaterialContext& context, const std::string& prefix) {
    const FloatSlot both = read_float(context.build, context.reader, prefix + "roughness");
    const auto along = [&](const std::string& name) {
        return context.reader.has(name) ? read_float(context.build, context.reader, name) : both;
    };
    const Roughness roughness{along(prefix + "uroughness"), along(prefix + "vroughness")};
    if (roughness.u.value != roughness.v.value || roughness.u.texture != roughness.v.texture)
        context.ask(kernel::EFFECT_ANISOTROPIC);
    return roughness;
}

Roughness read_base_roughness(MaterialContext& context, const std::string& prefix) {
    kernel::MaterialRecord& record = context.record;
    const Roughness roughness = read_roughness(context, prefix);
    record.roughness_u = roughness.u.value, record.roughness_v = roughness.v.value;
    record.roughness_u_texture = roughness.u.texture, record.roughness_v_texture = roughness.v.texture;
    if (context.reader.get_bool("remaproughness")) record.flags |= kernel::MATERIAL_REMAP;
    if (!roughness.smooth()) context.ask(kernel::EFFECT_ROUGH);
    return roughness;
}

float roughest_alpha(const Roughness& roughness, bool remapped) {
    if (roughness.u.texture != kNone || roughness.v.texture != kNone) return kRoughestDiffuse;
    const float roughest = std::max({roughness.u.value, roughness.v.value, 0.0f});
    return remapped ? std::sqrt(roughest) : roughest;
}

ParameterSpec remap_spec() {
    return boolean("remaproughness", true,
                   "whether the microfacets' alpha is the root of the roughness, or the roughness itself");
}

ParameterSpec eta_spec(const std::string& name, const std::string& of_what) {
    ParameterSpec spec =
        real(name, 1.5, "index of refraction of " + of_what + "; a spectrum would need dispersion").above(0);
    spec.spectral = true;
    return spec;
}

float read_eta(MaterialContext& context, std::string_view name) {
    constexpr float kSodiumLine = 587.6f;
    const Parameter* parameter = context.reader.find(name);
    if (!parameter || parameter->type == ParameterType::kFloat) return context.reader.get_float(name);
    const float fallback = float(find_spec(context.reader.specs(), name)->number);
    float eta = fallback;
    if (parameter->type != ParameterType::kSpectrum && parameter->type != ParameterType::kBlackbody) {
        context.reader.error(name, fmt::format("\"{}\" is of type {}", name, type_name(parameter->type)),
                             "float, or spectrum");
        return fallback;
    }
    const auto spectrum = sampled_spectrum(*parameter, SpectrumUse::kUnbounded, context.build.description.folder,
                                           context.build.diagnostics);
    if (!spectrum) return fallback;
    const auto [low, high] = std::minmax_element(spectrum->values.begin(), spectrum->values.end());
    eta = *low == *high ? *low : spectrum->at(kSodiumLine);
    if (*low != *high)
        context.build.diagnostics.unsupported(
            context.reader.location(name), "dispersion (an index of refraction that depends on the wavelength)",
            fmt::format("--skip-unsupported uses a constant, \"float {}\" {:.4f}, instead", name, eta));
    if (eta > 0.0f) return eta;
    context.reader.error(name, fmt::format("\"{}\" is {:g} at {} nm", name, eta, kSodiumLine), "it must be above 0");
    return fallback;
}

void set_color0(MaterialContext& context, const ColorSlot& slot) {
    context.record.color0 = slot.value;
    context.record.color0_texture = slot.texture;
}
void set_color1(MaterialContext& context, const ColorSlot& slot) {
    context.record.color1 = slot.value;
    context.record.color1_texture = slot.texture;
}
void set_color2(MaterialContext& context, const ColorSlot& slot) {
    context.record.color2 = slot.value;
    context.record.color2_texture = slot.texture;
}

void add_conductor(ParameterSpecs& specs, const std::string& prefix) {
    specs.push_back(
        value(prefix + "eta", ParameterType::kSpectrum, "metal-Cu-eta", "real part of the index of refraction")
            .textured());
    specs.push_back(value(prefix + "k", ParameterType::kSpectrum, "metal-Cu-k", "its imaginary part").textured());
    specs.push_back(value("reflectance", ParameterType::kSpectrum, "from eta and k",
                          "reflectance at normal incidence, instead of eta and k")
                        .textured());
    specs.push_back(boolean("energycompensation", false,
                            "gives back what single scattering between microfacets loses (pbrt-v4 does not)"));
}

void read_conductor(MaterialContext& context, const std::string& prefix) {
    ParameterReader& reader = context.reader;
    const std::string eta = prefix + "eta", k = prefix + "k";
    context.ask(kernel::EFFECT_CONDUCTOR);
    if (reader.get_bool("energycompensation")) context.record.flags |= kernel::MATERIAL_ENERGY_COMPENSATION;
    if (reader.has("reflectance")) {
        if (reader.has(eta) || reader.has(k))
            reader.error("reflectance",
                         fmt::format("both \"reflectance\" and \"{}\" are given", reader.has(eta) ? eta : k),
                         "one of them");
        reader.find(eta), reader.find(k);
        context.record.flags |= kernel::MATERIAL_USES_REFLECTANCE;
        set_color0(context, read_color(context.build, reader, "reflectance", SpectrumUse::kAlbedo, Spectrum(0.5f)));
        return;
    }
    // If both are spectra, colours are chosen to match their reflectance: a metal's colour is not that of its mean eta
    // and k.
    const auto sampled = [&](const std::string& name, const char* absent) -> std::optional<SampledSpectrum> {
        const Parameter* parameter = reader.find(name);
        if (!parameter) return *named_spectrum(absent);
        if (parameter->type != ParameterType::kSpectrum) return {};
        const auto spectrum = sampled_spectrum(*parameter, SpectrumUse::kUnbounded, context.build.description.folder,
                                               context.build.diagnostics);
        return spectrum ? *spectrum : *named_spectrum(absent);  // an error is reported already
    };
    const std::optional<SampledSpectrum> eta_spectrum = sampled(eta, "metal-Cu-eta"),
                                         k_spectrum = sampled(k, "metal-Cu-k");
    if (eta_spectrum && k_spectrum) {
        const ConductorRgb rgb = conductor_rgb(*eta_spectrum, *k_spectrum);
        set_color0(context, {spectrum_of_rgb(rgb.eta), kNone, true});
        set_color1(context, {spectrum_of_rgb(rgb.k), kNone, true});
        return;
    }
    static const ConductorRgb copper = conductor_rgb(*named_spectrum("metal-Cu-eta"), *named_spectrum("metal-Cu-k"));
    set_color0(context, read_color(context.build, reader, eta, SpectrumUse::kUnbounded, spectrum_of_rgb(copper.eta)));
    set_color1(context, read_color(context.build, reader, k, SpectrumUse::kUnbounded, spectrum_of_rgb(copper.k)));
}

}  // namespace lampyris

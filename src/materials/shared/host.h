// Functions for the host's parts of several materials.
#pragma once

#include "core/scene/builder.h"

namespace lampyris {

// Adds the specs that every material has, displacement and normalmap, to `specs`.
ParameterSpecs with_surface_detail(ParameterSpecs specs);
void read_surface_detail(MaterialContext& context);

// "roughness", "uroughness", "vroughness" (with a prefix for the layers of coatedconductor).
void add_roughness(ParameterSpecs& specs, const std::string& prefix, double default_value, const std::string& of_what);
struct Roughness {
    FloatSlot u, v;
    bool smooth() const { return u.texture == kNone && v.texture == kNone && u.value == 0.0f && v.value == 0.0f; }
};
Roughness read_roughness(MaterialContext& context, const std::string& prefix);
ParameterSpec remap_spec();
// The same, and stores it in the record's roughness_u and roughness_v, with MATERIAL_REMAP if "remaproughness" is true.
Roughness read_base_roughness(MaterialContext& context, const std::string& prefix);
// Its GGX alpha, for MaterialRecord::roughest_alpha; that of a textured roughness is unbounded.
float roughest_alpha(const Roughness& roughness, bool remapped);

// A refractive index that does not depend on the wavelength. A spectrum that varies is dispersion, which is not
// supported; if that is skipped, its value at the sodium d line (587.6 nm) is used.
ParameterSpec eta_spec(const std::string& name, const std::string& of_what);
float read_eta(MaterialContext& context, std::string_view name);

// Reads eta and k, or reflectance, into color0 and color1, with flags and textures.
void add_conductor(ParameterSpecs& specs, const std::string& prefix);
void read_conductor(MaterialContext& context, const std::string& prefix);

// The coat of "coateddiffuse" and "coatedconductor"; `eta` is the name of the parameter with its refractive index.
ParameterSpecs with_coat(ParameterSpecs specs);
void read_coat(MaterialContext& context, const std::string& eta);

void set_color0(MaterialContext& context, const ColorSlot& slot);
void set_color1(MaterialContext& context, const ColorSlot& slot);
void set_color2(MaterialContext& context, const ColorSlot& slot);

}  // namespace lampyris

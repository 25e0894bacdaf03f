// Material "coateddiffuse": plastic or varnish, a dielectric coat over a diffuse base.
#ifndef LAMPYRIS_MATERIALS_COATEDDIFFUSE
#define LAMPYRIS_MATERIALS_COATEDDIFFUSE

#include "materials/shared/coat.h"

FN Bsdf coateddiffuse_make(IN(MaterialRecord) m) {
    Bsdf b = coat_make(m, record_roughness(m));
    b.flags = m.flags;
    b.color0 = bounded_share(m.color0);
    if (clear_coat_applies(b)) b.inner = clear_coat_inner_reflectance(b.eta, b.thickness);
    return b;
}

FN bool coateddiffuse_is_specular(IN(Bsdf) b) { return false; }
FN bool coateddiffuse_chooses_lobe(IN(Bsdf) b) { return true; }
FN bool coateddiffuse_transmits(IN(Bsdf) b) { return false; }

// The coat's reflection, plus the base seen through the coat, with the diffuse inner reflectance R_i = 1 - (1 - R) /
// eta^2.
FN Spectrum coateddiffuse_albedo(IN(Bsdf) b) {
    float r = fresnel_dielectric(1.0f, b.eta);
    Spectrum base = b.color0;
    float inner = max(1.0f - (1.0f - r) / (b.eta * b.eta), 0.0f);
    return Spectrum(r) + (1.0f - r) * (1.0f - inner) * (base / (Spectrum(1.0f) - base * inner));
}

FN uint coateddiffuse_visible_action(IN(Bsdf) b, float roughness) {
    return dielectric_lobe_is_specular(b.alpha, b.eta) ? VISIBLE_SPLIT : VISIBLE_GATHER;
}

#endif

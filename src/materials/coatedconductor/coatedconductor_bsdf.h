// Material "coatedconductor": varnished metal, a dielectric coat over a conductor.
#ifndef LAMPYRIS_MATERIALS_COATEDCONDUCTOR
#define LAMPYRIS_MATERIALS_COATEDCONDUCTOR

#include "materials/shared/coat.h"

// The record has n + ik of the bare metal; under the coat, both are divided by the coat's index.
FN Bsdf coatedconductor_make(IN(MaterialRecord) m) {
    Bsdf b =
        coat_make(m, roughness_alpha(m.coat_roughness_u, m.coat_roughness_v, (m.flags & MATERIAL_REMAP_COAT) != 0u));
    b.flags = m.flags;
    Spectrum n;
    Spectrum k;
    conductor_index(m, n, k);
    b.color0 = bounded_index(n / b.eta);
    b.color1 = bounded_index(k / b.eta);
    b.alpha_base = record_alpha(m);
    return b;
}

FN bool coatedconductor_is_specular(IN(Bsdf) b) { return coat_is_specular(b) && ggx_is_smooth(b.alpha_base); }
FN bool coatedconductor_chooses_lobe(IN(Bsdf) b) { return true; }
FN bool coatedconductor_transmits(IN(Bsdf) b) { return false; }

FN Spectrum coatedconductor_albedo(IN(Bsdf) b) {
    float r = fresnel_dielectric(1.0f, b.eta);
    return Spectrum(r) + (1.0f - r) * (1.0f - r) * fresnel_conductor(1.0f, b.color0, b.color1);
}

FN uint coatedconductor_visible_action(IN(Bsdf) b, float roughness) {
    if (coatedconductor_is_specular(b)) return VISIBLE_FOLLOW;
    bool smooth_coat = dielectric_lobe_is_specular(b.alpha, b.eta);
    bool narrow_base = max(b.alpha_base.x, b.alpha_base.y) < roughness;
    if (narrow_base && (smooth_coat || max(b.alpha.x, b.alpha.y) < roughness)) return VISIBLE_FOLLOW;
    return smooth_coat ? VISIBLE_SPLIT : VISIBLE_GATHER;
}

#endif

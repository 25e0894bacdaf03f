// Common to the coated materials: the coat of a record, and their evaluation and sampling (SCATTERS_AS coat).
#ifndef LAMPYRIS_MATERIALS_COAT
#define LAMPYRIS_MATERIALS_COAT

#include "materials/shared/clear_coat.h"
#include "materials/shared/layered.h"

// A coat of the given roughness; the caller adds the base.
FN Bsdf coat_make(IN(MaterialRecord) m, vec2 alpha) {
    Bsdf b = no_bsdf();
    b.eta = bounded_eta(m.eta);
    b.alpha = ggx_alpha(alpha.x, alpha.y);
    b.thickness = clamp(m.thickness, 1e-20f, 1e20f);
    b.albedo = bounded_share(m.color2);
    b.g = clamp(m.g, -0.99f, 0.99f);
    b.max_depth = m.max_depth;
    b.samples = max(m.samples, 1u);
    return b;
}

// Whether the walk through a coat over a specular base has only delta lobes.
FN bool coat_is_specular(IN(Bsdf) b) { return dielectric_lobe_is_specular(b.alpha, b.eta) && is_black(b.albedo); }

FN Spectrum coat_eval(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport, uint jobs, OUT(float) pdf) {
    if (RARELY(b.inner >= 0.0f)) return clear_coat_eval(b, wo, wi, pdf);
    Bsdf coated = b;
    BsdfSample none = no_bsdf_sample();
    Spectrum value;
    float density;
    layered_scatter(coated, wo, wi, 0.0f, vec2(0.0f), transport, jobs, none, value, density);
    pdf = density;
    return value;
}

FN bool coat_sample(IN(Bsdf) b, vec3 wo, float uc, vec2 u, uint transport, uint jobs, INOUT(BsdfSample) s,
                    OUT(float) density) {
    density = 0.0f;
    if (RARELY(b.inner >= 0.0f)) return clear_coat_sample(b, wo, uc, u, s);
    Bsdf coated = b;
    BsdfSample chosen = s;
    Spectrum value;
    float chosen_density;
    bool found =
        layered_scatter(coated, wo, wo, uc, u, transport, LAYERED_SAMPLE | jobs, chosen, value, chosen_density);
    s = chosen;
    density = chosen_density;
    return found;
}

#endif

// Material "orennayar": clay or plaster, a rough surface of diffuse facets (Oren and Nayar 1994, in the form of Fujii 2012, "A
// Tiny Improvement of Oren-Nayar Reflectance Model"). Members of the Bsdf: color0 is the reflectance, g the roughness.
#ifndef ORENNAYAR_MATERIAL
#define ORENNAYAR_MATERIAL

#include "materials/diffuse/diffuse_bsdf.h"

// The record's slots hold what the scene asks for, textures included. What scenes may not ask for ends here.
FN Bsdf orennayar_make(IN(MaterialRecord) m) {
    Bsdf b = no_bsdf();
    b.color0 = bounded_share(m.color0);
    b.g = clamp(m.roughness_u, 0.0f, 1.0f);
    return b;
}

FN bool orennayar_is_specular(IN(Bsdf) b) { return false; }
FN bool orennayar_chooses_lobe(IN(Bsdf) b) { return false; }
FN bool orennayar_transmits(IN(Bsdf) b) { return false; }
FN Spectrum orennayar_albedo(IN(Bsdf) b) { return b.color0; }
FN uint orennayar_visible_action(IN(Bsdf) b, float roughness) { return VISIBLE_GATHER; }

// (1 + sigma s / t) / (pi + (pi / 2 - 2 / 3) sigma), with s the product of the sines with the cosine of the difference in azimuth.
FN Spectrum orennayar_value(IN(Bsdf) b, vec3 wo, vec3 wi) {
    float s = dot3(wo, wi) - wo.z * wi.z;
    float t = s > 0.0f ? max(abs(wo.z), abs(wi.z)) : 1.0f;
    return b.color0 * (max(1.0f + b.g * s / t, 0.0f) / (PI + 0.90412966f * b.g));
}

FN Spectrum orennayar_eval(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport, OUT(float) pdf) {
    pdf = 0.0f;
    if (!same_hemisphere(wo, wi)) return Spectrum(0.0f);
    pdf = pdf_cosine_hemisphere(abs(wi.z));
    return orennayar_value(b, wo, wi);
}

FN bool orennayar_sample(IN(Bsdf) b, vec3 wo, float uc, vec2 u, uint transport, INOUT(BsdfSample) s) {
    if (!diffuse_lobe_sample(b.color0, wo, u, s)) return false;
    s.f = orennayar_value(b, wo, s.wi);
    return true;
}

#endif

// Scattering at surfaces: what a material does with light, as evaluation, density and sampling over all kinds.
//
// docs/kernels-scattering.md says which paper each model is from, and where it departs from pbrt's.
#ifndef LAMPYRIS_KERNEL_BSDF
#define LAMPYRIS_KERNEL_BSDF

// GLSL wants this order.
// clang-format off
#include "core/kernel/sampling.h"
#include "core/kernel/fresnel.h"
#include "core/kernel/microfacet.h"
#include "core/kernel/bsdf_types.h"
#include "core/kernel/bsdf_diffuse.h"
#include "core/kernel/bsdf_conductor.h"
#include "core/kernel/bsdf_dielectric.h"
#include "core/kernel/bsdf_layered.h"
#include "core/kernel/bsdf_clear_coat.h"
// clang-format on

// ---- Making one ------------------------------------------------------------------------------------------------------
// These bound every parameter to where the functions below are finite: scenes may ask for anything.

FN Bsdf bsdf_interface() {
    Bsdf b;
    b.kind = MATERIAL_INTERFACE;
    b.flags = 0u;
    b.color0 = vec3(0.0f);
    b.color1 = vec3(0.0f);
    b.albedo = vec3(0.0f);
    b.alpha = vec2(0.0f, 0.0f);
    b.alpha_base = vec2(0.0f, 0.0f);
    b.eta = 1.0f;
    b.thickness = 0.0f;
    b.g = 0.0f;
    b.max_depth = 0u;
    b.samples = 1u;
    b.walk = 0u;
    b.inner = -1.0f;
    return b;
}

FN vec3 bounded_share(vec3 c) { return vec3(clamp(c.x, 0.0f, 1.0f), clamp(c.y, 0.0f, 1.0f), clamp(c.z, 0.0f, 1.0f)); }
FN vec3 bounded_index(vec3 c) { return vec3(clamp(c.x, 0.0f, 1e4f), clamp(c.y, 0.0f, 1e4f), clamp(c.z, 0.0f, 1e4f)); }
// A relative index; pbrt reads 0 as 1.
FN float bounded_eta(float eta) { return eta > 0.0f ? clamp(eta, 0.01f, 100.0f) : 1.0f; }

FN Bsdf bsdf_diffuse(vec3 reflectance) {
    Bsdf b = bsdf_interface();
    b.kind = MATERIAL_DIFFUSE;
    b.color0 = bounded_share(reflectance);
    return b;
}

FN Bsdf bsdf_diffuse_transmission(vec3 reflectance, vec3 transmittance) {
    Bsdf b = bsdf_interface();
    b.kind = MATERIAL_DIFFUSE_TRANSMISSION;
    b.color0 = bounded_share(reflectance);
    b.color1 = bounded_share(transmittance);
    return b;
}

// k for which a conductor with n = 1 has the given normal reflectance (pbrt, 4th edition, section 9.3.6).
FN vec3 conductor_k_of_reflectance(vec3 reflectance) {
    vec3 r = vec3(clamp(reflectance.x, 0.0f, 0.9999f), clamp(reflectance.y, 0.0f, 0.9999f),
                  clamp(reflectance.z, 0.0f, 0.9999f));
    return vec3(2.0f * sqrt(r.x / (1.0f - r.x)), 2.0f * sqrt(r.y / (1.0f - r.y)), 2.0f * sqrt(r.z / (1.0f - r.z)));
}

// n + ik relative to the outside; alpha as given by the user, remapped already. flags: MATERIAL_ENERGY_COMPENSATION.
FN Bsdf bsdf_conductor(vec3 n, vec3 k, vec2 alpha, uint flags) {
    Bsdf b = bsdf_interface();
    b.kind = MATERIAL_CONDUCTOR;
    b.flags = flags;
    b.color0 = bounded_index(n);
    b.color1 = bounded_index(k);
    b.alpha = ggx_alpha(alpha.x, alpha.y);
    return b;
}

FN Bsdf bsdf_dielectric(float eta, vec2 alpha) {
    Bsdf b = bsdf_interface();
    b.kind = MATERIAL_DIELECTRIC;
    b.eta = bounded_eta(eta);
    b.alpha = ggx_alpha(alpha.x, alpha.y);
    return b;
}

FN Bsdf bsdf_thin_dielectric(float eta) {
    Bsdf b = bsdf_interface();
    b.kind = MATERIAL_THIN_DIELECTRIC;
    b.eta = bounded_eta(eta);
    return b;
}

// A coat of index eta and roughness alpha over nothing yet; thickness in mean free paths.
FN Bsdf bsdf_coat(float eta, vec2 alpha, float thickness, vec3 albedo, float g, uint max_depth, uint samples) {
    Bsdf b = bsdf_interface();
    b.eta = bounded_eta(eta);
    b.alpha = ggx_alpha(alpha.x, alpha.y);
    b.thickness = clamp(thickness, 1e-20f, 1e20f);
    b.albedo = bounded_share(albedo);
    b.g = clamp(g, -0.99f, 0.99f);
    b.max_depth = max_depth;
    b.samples = max(samples, 1u);
    return b;
}

// flags: MATERIAL_EXACT_COAT.
FN Bsdf bsdf_coated_diffuse(IN(Bsdf) coat, vec3 reflectance, uint flags) {
    Bsdf b = coat;
    b.kind = MATERIAL_COATED_DIFFUSE;
    b.flags = flags;
    b.color0 = bounded_share(reflectance);
    if (clear_coat_applies(b)) b.inner = clear_coat_inner_reflectance(b.eta, b.thickness);
    return b;
}

// n + ik of the bare metal: under the coat both are relative to the coat's index. flags: MATERIAL_EXACT_COAT and
// MATERIAL_ENERGY_COMPENSATION.
FN Bsdf bsdf_coated_conductor(IN(Bsdf) coat, vec3 n, vec3 k, vec2 alpha, uint flags) {
    Bsdf b = coat;
    b.kind = MATERIAL_COATED_CONDUCTOR;
    b.flags = flags;
    b.color0 = bounded_index(n / b.eta);
    b.color1 = bounded_index(k / b.eta);
    b.alpha_base = ggx_alpha(alpha.x, alpha.y);
    return b;
}

// ---- Asking it -------------------------------------------------------------------------------------------------------

FN bool bsdf_is_layered(IN(Bsdf) b) { return b.kind == MATERIAL_COATED_DIFFUSE || b.kind == MATERIAL_COATED_CONDUCTOR; }

// Only delta lobes: light is found by sampling directions alone, not by choosing a point on a light.
FN bool bsdf_is_specular(IN(Bsdf) b) {
    if (b.kind == MATERIAL_DIFFUSE || b.kind == MATERIAL_DIFFUSE_TRANSMISSION) return false;
    if (HAS(EFFECT_CONDUCTOR) && b.kind == MATERIAL_CONDUCTOR) return ggx_is_smooth(b.alpha);
    if (HAS(EFFECT_DIELECTRIC) && b.kind == MATERIAL_DIELECTRIC) return dielectric_is_specular(b.alpha, b.eta);
    if (HAS(EFFECT_COAT) && bsdf_is_layered(b)) {
        return dielectric_is_specular(b.alpha, b.eta) && base_is_specular(b) && is_black(b.albedo);
    }
    return true;
}

// Whether bsdf_sample looks at its number `uc`.
FN bool bsdf_chooses_lobe(IN(Bsdf) b) {
    if (!HAS(EFFECT_DIELECTRIC | EFFECT_THIN_DIELECTRIC | EFFECT_DIFFUSE_TRANSMISSION | EFFECT_COAT)) return false;
    return b.kind != MATERIAL_DIFFUSE && b.kind != MATERIAL_CONDUCTOR;
}

// Value f(wo, wi) without the cosine, and density of bsdf_sample choosing wi (per solid angle): 0 where only delta lobes
// scatter. `transport` says what flows along wi -> wo. `jobs`: which of the two a coat is asked for, LAYERED_VALUE and
// LAYERED_DENSITY; of other materials, what is not used costs nothing after inlining.
FN vec3 bsdf_eval_jobs(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport, uint jobs, OUT(float) pdf) {
    pdf = 0.0f;
    if (is_grazing(wo) || is_grazing(wi)) return vec3(0.0f);
    if (b.kind == MATERIAL_DIFFUSE) return diffuse_eval(b.color0, wo, wi, pdf);
    if (HAS(EFFECT_CONDUCTOR) && b.kind == MATERIAL_CONDUCTOR) {
        return conductor_eval(b.color0, b.color1, b.alpha, b.flags, wo, wi, pdf);
    }
    if (HAS(EFFECT_DIELECTRIC) && b.kind == MATERIAL_DIELECTRIC) {
        return dielectric_eval(b.alpha, b.eta, wo, wi, transport, LOBE_BOTH_SIDES, pdf);
    }
    if (HAS(EFFECT_DIFFUSE_TRANSMISSION) && b.kind == MATERIAL_DIFFUSE_TRANSMISSION) {
        return diffuse_transmission_eval(b.color0, b.color1, wo, wi, pdf);
    }
    if (HAS(EFFECT_COAT) && RARELY(b.inner >= 0.0f)) return clear_coat_eval(b, wo, wi, pdf);
    if (HAS(EFFECT_COAT) && RARELY(bsdf_is_layered(b))) {
        Bsdf coated = b;
        BsdfSample none = no_bsdf_sample();
        vec3 value;
        float density;
        layered_scatter(coated, wo, wi, 0.0f, vec2(0.0f), transport, jobs, none, value, density);
        pdf = density;
        return value;
    }
    return vec3(0.0f);
}

FN vec3 bsdf_eval_pdf(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport, OUT(float) pdf) {
    return bsdf_eval_jobs(b, wo, wi, transport, LAYERED_VALUE | LAYERED_DENSITY, pdf);
}

FN vec3 bsdf_eval(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport) {
    float pdf;
    return bsdf_eval_jobs(b, wo, wi, transport, LAYERED_VALUE, pdf);
}

FN float bsdf_pdf(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport) {
    float pdf;
    bsdf_eval_jobs(b, wo, wi, transport, LAYERED_DENSITY, pdf);
    return pdf;
}

// A direction wi, from three uniform numbers; false where nothing is scattered (the path ends). `jobs`: LAYERED_DENSITY, or nothing.
FN bool bsdf_sample_jobs(IN(Bsdf) b, vec3 wo, float uc, vec2 u, uint transport, uint jobs, OUT(BsdfSample) s,
                         OUT(float) density) {
    s = no_bsdf_sample();
    density = 0.0f;
    if (is_grazing(wo)) return false;
    bool found = false;
    if (b.kind == MATERIAL_DIFFUSE) {
        found = diffuse_sample(b.color0, wo, u, s);
    } else if (HAS(EFFECT_CONDUCTOR) && b.kind == MATERIAL_CONDUCTOR) {
        found = conductor_sample(b.color0, b.color1, b.alpha, b.flags, wo, u, s);
    } else if (HAS(EFFECT_DIELECTRIC) && b.kind == MATERIAL_DIELECTRIC) {
        found = dielectric_sample(b.alpha, b.eta, wo, uc, u, transport, LOBE_BOTH_SIDES, s);
    } else if (HAS(EFFECT_THIN_DIELECTRIC) && b.kind == MATERIAL_THIN_DIELECTRIC) {
        found = thin_dielectric_sample(b.eta, wo, uc, s);
    } else if (HAS(EFFECT_DIFFUSE_TRANSMISSION) && b.kind == MATERIAL_DIFFUSE_TRANSMISSION) {
        found = diffuse_transmission_sample(b.color0, b.color1, wo, uc, u, s);
    } else if (HAS(EFFECT_COAT) && RARELY(b.inner >= 0.0f)) {
        found = clear_coat_sample(b, wo, uc, u, s);
    } else if (HAS(EFFECT_COAT) && RARELY(bsdf_is_layered(b))) {
        Bsdf coated = b;
        BsdfSample chosen = s;
        vec3 value;
        float chosen_density;
        found = layered_scatter(coated, wo, wo, uc, u, transport, LAYERED_SAMPLE | jobs, chosen, value, chosen_density);
        s = chosen;
        density = chosen_density;
    }
    if (s.pdf_is_proportional == 0u) density = s.pdf;
    return found && s.pdf > 0.0f && !is_black(s.f);
}

FN bool bsdf_sample(IN(Bsdf) b, vec3 wo, float uc, vec2 u, uint transport, OUT(BsdfSample) s) {
    float density;
    return bsdf_sample_jobs(b, wo, uc, u, transport, 0u, s, density);
}

// The same, with the density of the direction as multiple importance sampling wants it, which s.pdf is not where it is
// proportional; of a delta lobe, the probability of choosing it.
FN bool bsdf_sample_density(IN(Bsdf) b, vec3 wo, float uc, vec2 u, uint transport, OUT(BsdfSample) s,
                            OUT(float) density) {
    return bsdf_sample_jobs(b, wo, uc, u, transport, LAYERED_DENSITY, s, density);
}

// The share of light that it scatters, roughly and without noise: for the albedo channel of images.
FN vec3 bsdf_albedo(IN(Bsdf) b) {
    if (b.kind == MATERIAL_DIFFUSE) return b.color0;
    if (HAS(EFFECT_DIFFUSE_TRANSMISSION) && b.kind == MATERIAL_DIFFUSE_TRANSMISSION)
        return bounded_share(b.color0 + b.color1);
    if (HAS(EFFECT_CONDUCTOR) && b.kind == MATERIAL_CONDUCTOR) return fresnel_conductor(1.0f, b.color0, b.color1);
    if (HAS(EFFECT_COAT) && bsdf_is_layered(b)) {
        // A coat's own reflection, and the base seen through it with a diffuse inner reflection of R_i = 1 - (1 - R) / eta^2.
        float r = fresnel_dielectric(1.0f, b.eta);
        vec3 base = b.color0;
        if (b.kind == MATERIAL_COATED_CONDUCTOR)
            return r + (1.0f - r) * (1.0f - r) * fresnel_conductor(1.0f, b.color0, b.color1);
        float inner = max(1.0f - (1.0f - r) / (b.eta * b.eta), 0.0f);
        return vec3(r) + (1.0f - r) * (1.0f - inner) * (base / (vec3(1.0f) - base * inner));
    }
    return vec3(1.0f);
}

#endif

// Scattering at surfaces: what a material does with light, as evaluation, density and sampling over all kinds. The materials
// are in src/materials; from their folders the build writes what calls them (src/materials/dispatch.h.in).
//
// docs/kernels-scattering.md says which paper each model is from, and where it departs from pbrt's.
#ifndef LAMPYRIS_KERNEL_BSDF
#define LAMPYRIS_KERNEL_BSDF

// GLSL wants this order.
// clang-format off
#include "core/kernel/spectrum.h"
#include "core/kernel/sampling.h"
#include "core/kernel/fresnel.h"
#include "core/kernel/microfacet.h"
#include "core/kernel/bsdf_types.h"
#include "materials/dispatch.h"
// clang-format on

FN Spectrum bsdf_eval_pdf(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport, OUT(float) pdf) {
    return bsdf_eval_jobs(b, wo, wi, transport, LAYERED_VALUE | LAYERED_DENSITY, pdf);
}

FN Spectrum bsdf_eval(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport) {
    float pdf;
    return bsdf_eval_jobs(b, wo, wi, transport, LAYERED_VALUE, pdf);
}

FN float bsdf_pdf(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport) {
    float pdf;
    bsdf_eval_jobs(b, wo, wi, transport, LAYERED_DENSITY, pdf);
    return pdf;
}

// A direction wi, from three uniform numbers; false where nothing is scattered (the path ends).
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

#endif

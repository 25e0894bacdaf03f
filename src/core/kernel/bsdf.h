// Scattering at surfaces: evaluates, samples, and computes the density of a material's BSDF. The materials are in
// src/materials; the build generates the dispatch over them (src/materials/dispatch.h.in).
//
// docs/kernels-scattering.md names the paper of each model, and its differences from pbrt's.
#ifndef LAMPYRIS_KERNEL_BSDF
#define LAMPYRIS_KERNEL_BSDF

// GLSL needs this order.
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

// The same, with the densities of both directions: of sampling wi from wo, and of sampling wo from wi if the other quantity is
// transported (a path from the other end). For methods that weigh paths from camera and lights.
FN Spectrum bsdf_eval_pdfs(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport, OUT(float) forward, OUT(float) reverse) {
    reverse = bsdf_pdf(b, wi, wo, TRANSPORT_IMPORTANCE - transport);
    return bsdf_eval_pdf(b, wo, wi, transport, forward);
}

// Samples a direction wi with three uniform random numbers; false if nothing is scattered (the path ends).
FN bool bsdf_sample(IN(Bsdf) b, vec3 wo, float uc, vec2 u, uint transport, OUT(BsdfSample) s) {
    float density;
    return bsdf_sample_jobs(b, wo, uc, u, transport, 0u, s, density);
}

// The same, and also computes the direction's density for multiple importance sampling, which s.pdf is not if it is
// only proportional to the density. For a delta lobe it is the probability of choosing that lobe.
FN bool bsdf_sample_density(IN(Bsdf) b, vec3 wo, float uc, vec2 u, uint transport, OUT(BsdfSample) s,
                            OUT(float) density) {
    return bsdf_sample_jobs(b, wo, uc, u, transport, LAYERED_DENSITY, s, density);
}

#endif

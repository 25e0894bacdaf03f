// Calls scattering functions, for tests: samples them, or evaluates them at given directions.
#include "core/kernel/prelude.h"
#ifndef __cplusplus
#include "core/kernel/effects.h"
#include "core/kernel/layout.h"
#endif
#include "core/kernel/math.h"
#include "core/kernel/surface.h"
// This order is required by GLSL.
// clang-format off
#include "core/kernel/random.h"
#include "core/kernel/bsdf.h"
// clang-format on

CONST uint PROBE_SAMPLE =
    0u;  // results[4 i ...]: wi, pdf; f, eta; eval's f and pdf at wi; lobe, found, pdf_is_proportional
CONST uint PROBE_EVAL = 1u;          // inputs[2 i ...]: wo, wi; results[i]: f, pdf
CONST uint PROBE_EVAL_AT_WO = 2u;    // inputs[i]: wi
CONST uint PROBE_EVAL_UNIFORM = 3u;  // results[4 i ...]: a uniform direction wi, pdf; f; -; -
CONST uint PROBE_EVERYTHING =
    4u;  // inputs[4 i ...]: wo, uc; wi, transport; u; -: samples and evaluates; results as PROBE_SAMPLE
CONST uint PROBE_PROPERTIES = 5u;  // results[i]: albedo, specular
CONST uint PROBE_BOTH = 6u;        // inputs[2 i ...]: wo, wi; results[2 i ...]: f, pdf; -, pdf of the other direction

struct BsdfProbe {
    uvec4 what;  // operation, seed, transport, stride: index i asks probes[i / stride]
    uvec4 kind;  // kind, flags, max_depth, samples
    vec4 color0;
    vec4 color1;
    vec4 albedo;
    vec4 alpha;  // x, y; of coatedconductor's coat: z, w
    vec4 coat;   // eta, thickness, g
    vec4 wo;
};

BUFFER_RO(0, BsdfProbe, probes)
BUFFER_RO(1, vec4, inputs)
BUFFER_RW(2, vec4, results)

FN Bsdf probed_bsdf(IN(BsdfProbe) p) {
    MaterialRecord m;
    m.kind = p.kind.x;
    m.flags = p.kind.y;
    m.color0 = spectrum_of(p.color0);
    m.scale = 1.0f;
    m.color1 = spectrum_of(p.color1);
    m.color2 = spectrum_of(p.albedo);
    m.roughness_u = p.alpha.x;
    m.roughness_v = p.alpha.y;
    m.eta = p.coat.x;
    m.g = p.coat.z;
    m.thickness = p.coat.y;
    m.coat_roughness_u = p.alpha.z;
    m.coat_roughness_v = p.alpha.w;
    m.max_depth = p.kind.z;
    m.samples = p.kind.w;
    return bsdf_of_record(m);
}

KERNEL(bsdf_probe) {
    BsdfProbe p = probes[index / probes[0].what.w];
    Bsdf b = probed_bsdf(p);
    uint operation = p.what.x;
    uint transport = p.what.z;
    vec3 wo = vec3(p.wo);
    vec3 wi = vec3(0.0f, 0.0f, 1.0f);
    float pdf = 0.0f;
    if (operation == PROBE_PROPERTIES) {
        results[index] = slot_of(bsdf_albedo(b), bsdf_is_specular(b) ? 1.0f : 0.0f);
        return;
    }
    if (operation == PROBE_EVAL || operation == PROBE_EVAL_AT_WO) {
        if (operation == PROBE_EVAL) {
            wo = vec3(inputs[2u * index]);
            wi = vec3(inputs[2u * index + 1u]);
        } else {
            wi = vec3(inputs[index]);
        }
        Spectrum f = bsdf_eval_pdf(b, wo, wi, transport, pdf);
        results[index] = slot_of(f, pdf);
        return;
    }
    if (operation == PROBE_BOTH) {
        float reverse;
        Spectrum f =
            bsdf_eval_pdfs(b, vec3(inputs[2u * index]), vec3(inputs[2u * index + 1u]), transport, pdf, reverse);
        results[2u * index] = slot_of(f, pdf);
        results[2u * index + 1u] = vec4(0.0f, 0.0f, 0.0f, reverse);
        return;
    }
    Rng rng = rng_begin(p.what.y, index);
    float uc = rng_float(rng);
    vec2 u;
    u.x = rng_float(rng);
    u.y = rng_float(rng);
    BsdfSample s = no_bsdf_sample();
    uint found = 0u;
    if (operation == PROBE_EVAL_UNIFORM) {
        s.wi = sample_uniform_sphere(u);
        s.pdf = pdf_uniform_sphere();
        Spectrum value = bsdf_eval(b, wo, s.wi, transport);
        results[4u * index] = vec4(s.wi, s.pdf);
        results[4u * index + 1u] = slot_of(value, 1.0f);
        return;
    } else {
        if (operation == PROBE_EVERYTHING) {
            wo = vec3(inputs[4u * index]);
            uc = inputs[4u * index].w;
            u = vec2(inputs[4u * index + 2u].x, inputs[4u * index + 2u].y);
            wi = vec3(inputs[4u * index + 1u]);
            transport = uint(inputs[4u * index + 1u].w);
        }
        if (bsdf_sample(b, wo, uc, u, transport, s)) {
            found = 1u;
            if (operation == PROBE_SAMPLE) wi = s.wi;
        }
    }
    Spectrum f = bsdf_eval(b, wo, wi, transport);
    pdf = bsdf_pdf(b, wo, wi, transport);
    results[4u * index] = vec4(s.wi, s.pdf);
    results[4u * index + 1u] = slot_of(s.f, s.eta);
    results[4u * index + 2u] = slot_of(f, pdf);
    results[4u * index + 3u] = vec4(float(s.lobe), float(found), float(s.pdf_is_proportional), 0.0f);
}

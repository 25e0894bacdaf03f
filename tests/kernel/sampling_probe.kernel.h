// Calls the sampling routines, for tests: points with their densities, or densities at given points.
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

CONST uint SAMPLING_DISK = 0u;
CONST uint SAMPLING_TRIANGLE = 1u;
CONST uint SAMPLING_COSINE_HEMISPHERE = 2u;
CONST uint SAMPLING_UNIFORM_HEMISPHERE = 3u;
CONST uint SAMPLING_UNIFORM_SPHERE = 4u;
CONST uint SAMPLING_CONE = 5u;               // a: 1 - cos
CONST uint SAMPLING_HENYEY_GREENSTEIN = 6u;  // a: g; about direction
CONST uint SAMPLING_VISIBLE_NORMAL = 7u;     // a, b: alpha; seen from direction
CONST uint SAMPLING_LINEAR = 8u;             // a, b
CONST uint SAMPLING_BILINEAR = 9u;           // a, b, c, d
CONST uint SAMPLING_TENT = 10u;              // a: radius
CONST uint SAMPLING_EXPONENTIAL = 11u;       // a

struct SamplingProbe {
    uvec4 what;  // function, seed, 1: densities at `points` only
    vec4 a;
    vec4 direction;
};

BUFFER_RO(0, SamplingProbe, probes)
BUFFER_RW(1, vec4, points)  // w: density

KERNEL(sampling_probe) {
    uint what = probes[0].what.x;
    vec4 a = probes[0].a;
    vec3 direction = vec3(probes[0].direction);
    vec3 p = vec3(points[index]);
    if (probes[0].what.z == 0u) {
        Rng rng = rng_begin(probes[0].what.y, index);
        vec2 u;
        u.x = rng_float(rng);
        u.y = rng_float(rng);
        vec2 flat_point = vec2(0.0f, 0.0f);
        if (what == SAMPLING_DISK) flat_point = sample_concentric_disk(u);
        if (what == SAMPLING_BILINEAR) flat_point = sample_bilinear(u, a);
        p = vec3(flat_point.x, flat_point.y, 0.0f);
        if (what == SAMPLING_TRIANGLE) p = sample_uniform_triangle(u);
        if (what == SAMPLING_COSINE_HEMISPHERE) p = sample_cosine_hemisphere(u);
        if (what == SAMPLING_UNIFORM_HEMISPHERE) p = sample_uniform_hemisphere(u);
        if (what == SAMPLING_UNIFORM_SPHERE) p = sample_uniform_sphere(u);
        if (what == SAMPLING_CONE) p = sample_uniform_cone(u, a.x);
        if (what == SAMPLING_HENYEY_GREENSTEIN) p = sample_henyey_greenstein(direction, a.x, u);
        if (what == SAMPLING_VISIBLE_NORMAL) p = ggx_sample_visible(direction, vec2(a.x, a.y), u);
        if (what == SAMPLING_LINEAR) p.x = sample_linear(u.x, a.x, a.y);
        if (what == SAMPLING_TENT) p.x = sample_tent(u.x, a.x);
        if (what == SAMPLING_EXPONENTIAL) p.x = sample_exponential(u.x, a.x);
    }
    float pdf = 0.0f;
    if (what == SAMPLING_DISK) pdf = pdf_concentric_disk();
    if (what == SAMPLING_TRIANGLE) pdf = 2.0f;  // over b0 and b1
    if (what == SAMPLING_COSINE_HEMISPHERE) pdf = pdf_cosine_hemisphere(p.z);
    if (what == SAMPLING_UNIFORM_HEMISPHERE) pdf = p.z < 0.0f ? 0.0f : pdf_uniform_hemisphere();
    if (what == SAMPLING_UNIFORM_SPHERE) pdf = pdf_uniform_sphere();
    if (what == SAMPLING_CONE) pdf = p.z < 1.0f - a.x ? 0.0f : pdf_uniform_cone(a.x);
    if (what == SAMPLING_HENYEY_GREENSTEIN) pdf = henyey_greenstein(dot3(direction, p), a.x);
    if (what == SAMPLING_VISIBLE_NORMAL && p.z > 0.0f) pdf = ggx_visible_pdf(direction, p, vec2(a.x, a.y));
    if (what == SAMPLING_LINEAR) pdf = pdf_linear(p.x, a.x, a.y);
    if (what == SAMPLING_BILINEAR) pdf = pdf_bilinear(vec2(p.x, p.y), a);
    if (what == SAMPLING_TENT) pdf = pdf_tent(p.x, a.x);
    if (what == SAMPLING_EXPONENTIAL) pdf = pdf_exponential(p.x, a.x);
    points[index] = vec4(p, pdf);
}

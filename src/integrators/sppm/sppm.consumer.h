// What a hit point makes of a photon: the BSDF times its power, as if it had arrived at the hit point itself.
// clang-format off
#define KERNEL_CPU_VARIANTS kAllEffects, kTexturedEffects, kGlassEffects
// clang-format on
#include "core/kernel/scene.h"

#include "core/kernel/gather.h"
#include "core/kernel/visible_point.h"
#include "integrators/sppm/sppm.layout.h"

BUFFER_RO(16, SppmHit, hits)
BUFFER_RW(17, vec4, gathered)
BUFFER_RW(18, vec4, biases)

struct Gathered {
    Bsdf bsdf;
    Frame frame;
    vec3 wo;  // local
    vec3 ng;  // on the side that the eye is on
    uint both_sides;
    float over_radius_squared;
    vec4 sum;   // BSDF times power; w: photons
    vec3 bias;  // what of the sum the radius has brought in: see gather_add
};

FN Gathered nothing_gathered() {
    Gathered g;
    g.bsdf = bsdf_interface();
    g.frame = frame_from_z(vec3(0.0f, 0.0f, 1.0f));
    g.wo = vec3(0.0f);
    g.ng = vec3(0.0f);
    g.both_sides = 0u;
    g.over_radius_squared = 0.0f;
    g.sum = vec4(0.0f);
    g.bias = vec3(0.0f);
    return g;
}

FN Gathered gather_begin(uint query) {
    SppmHit h = hits[query];
    Hit hit;
    hit.instance = h.origin.w;
    hit.geometry = h.direction.w;
    hit.primitive = h.more.x;
    vec3 origin = vec3(uintBitsToFloat(h.origin.x), uintBitsToFloat(h.origin.y), uintBitsToFloat(h.origin.z));
    vec3 direction =
        vec3(uintBitsToFloat(h.direction.x), uintBitsToFloat(h.direction.y), uintBitsToFloat(h.direction.z));
    Surface s = no_surface();
    surface_at(hit, origin, direction, s);
    Gathered g;
    g.ng = dot3(s.ng, direction) > 0.0f ? -s.ng : s.ng;
    g.bsdf = material_bsdf(s, -direction, g.frame);
    g.wo = to_local(g.frame, -direction);
    g.both_sides = bsdf_transmits(g.bsdf) ? 1u : 0u;
    float radius = queries[query].w;
    g.over_radius_squared = 1.0f / max(radius * radius, SMALLEST_RADIUS_SQUARED);
    g.sum = vec4(0.0f);
    g.bias = vec3(0.0f);
    return g;
}

FN void gather_add(INOUT(Gathered) g, uint query, IN(PhotonRecord) photon, float distance_squared, float weight) {
    vec3 incident = -photon_direction(photon);
    float cosine = dot3(incident, g.ng);
    // Photons on the back of a thin wall are none of this side's.
    if (g.both_sides == 0u && !(cosine > 0.0f)) return;
    vec3 wi = to_local(g.frame, incident);
    vec3 f = bsdf_eval(g.bsdf, g.wo, wi, TRANSPORT_RADIANCE);
    // Photons are counted on the geometric surface, the BSDF wants the shading normal's cosine (clamped where grazing).
    vec3 value = f * photon_power(photon) * (weight * abs(wi.z) / max(abs(cosine), GRAZING_COSINE));
    g.sum += vec4(value.x, value.y, value.z, weight);
    // A disk of radius r sees too much by r^2/8 times the Laplacian (Hachisuka et al. 2010, equation 6, with k2 = 1/4). That is
    // estimated by the Laplacian of the kernel 4 (1 - t)^3 / (pi r^2), t = d^2 / r^2: as a share of what the disk's own
    // kernel 1 / (pi r^2) counts, a photon has the weight 6 (1 - t) (3 t - 1).
    float t = distance_squared * g.over_radius_squared;
    g.bias += value * (6.0f * (1.0f - t) * (3.0f * t - 1.0f));
}

// For structures over the hit points: the surface is found again for each photon, and the bias is not estimated.
FN vec4 gather_value(uint query, IN(PhotonRecord) photon, float distance_squared) {
    Gathered g = gather_begin(query);
    gather_add(g, query, photon, distance_squared, 1.0f);
    return g.sum;
}

FN Gathered gather_sums(uint query, vec4 sums) {
    Gathered g = nothing_gathered();
    g.sum = sums;
    return g;
}

FN void gather_end(IN(Gathered) g, uint query) {
    gathered[query] += g.sum;
    biases[query] += vec4(g.bias.x, g.bias.y, g.bias.z, 0.0f);
}

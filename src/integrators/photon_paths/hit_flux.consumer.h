// A photon's contribution to a hit point: the BSDF times its power, as if it had arrived at the hit point itself.
#include "core/kernel/scene.h"

#include "core/kernel/gather.h"
#include "core/kernel/path_log_merge.h"
#include "integrators/photon_paths/hit_point.h"

BUFFER_RO(16, HitPointRecord, hits)
BUFFER_RW(17, vec4, gathered)
BUFFER_RW(18, vec4, biases)

struct Gathered {
    HitPoint point;
    float over_radius_squared;
    vec4 sum;       // BSDF times power; w: number of photons
    Spectrum bias;  // part of the sum that is due to the radius: see gather_add
};

// A photon in the path log; `reflected`: hit_point_reflects.
RARE_FN void log_gathered(uint query, PhotonRecord photon, vec4 reflected) {
    if (reflected.w == 0.0f) return;  // on the other side
    HitPointRecord hit = hits[query];
    float radius = queries[query].w;
    Spectrum share = spectrum_of(hit.throughput) * (1.0f / (PI * max(radius * radius, SMALLEST_RADIUS_SQUARED)));
    log_merge(query, hit_number(hit) - 1u, NONE, photon, share * spectrum_of(reflected), 1.0f, reflected.w);
}

FN Gathered gather_begin(uint query) {
    Gathered g;
    g.point = hit_point(hits[query]);
    float radius = queries[query].w;
    g.over_radius_squared = 1.0f / max(radius * radius, SMALLEST_RADIUS_SQUARED);
    g.sum = vec4(0.0f);
    g.bias = Spectrum(0.0f);
    return g;
}

FN void gather_add(INOUT(Gathered) g, uint query, IN(PhotonRecord) photon, float distance_squared, float weight) {
    vec4 value = hit_point_reflects(g.point, photon, weight);
    PATH_LOG(log_gathered(query, photon, value));
    g.sum += value;
    // A disk of radius r overestimates by r^2/8 times the Laplacian (Hachisuka et al. 2010, equation 6, with k2 = 1/4).
    // That is estimated by the Laplacian of the kernel 4 (1 - t)^3 / (pi r^2), t = d^2 / r^2. Relative to the disk's
    // own kernel 1 / (pi r^2), this gives a photon the weight 6 (1 - t) (3 t - 1).
    float t = distance_squared * g.over_radius_squared;
    g.bias += spectrum_of(value) * (6.0f * (1.0f - t) * (3.0f * t - 1.0f));
}

// For structures over the hit points: the surface is recomputed for each photon, and the bias is not estimated.
FN vec4 gather_value(uint query, IN(PhotonRecord) photon, float distance_squared) {
    vec4 value = hit_point_reflects(hit_point(hits[query]), photon, 1.0f);
    PATH_LOG(log_gathered(query, photon, value));
    return value;
}

FN Gathered gather_sums(uint query, vec4 sums) {
    Gathered g;
    g.point = no_hit_point();
    g.over_radius_squared = 0.0f;
    g.sum = sums;
    g.bias = Spectrum(0.0f);
    return g;
}

FN void gather_end(IN(Gathered) g, uint query) {
    gathered[query] += g.sum;
    biases[query] += slot_of(g.bias, 0.0f);
}

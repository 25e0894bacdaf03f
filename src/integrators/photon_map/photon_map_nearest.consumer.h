// Sums the photons nearest to a hit point, as hit_flux.consumer.h does for all photons in range, and scales the sum as if
// the whole radius had their density.
#include "core/kernel/scene.h"

#define GATHER_SHRINKS
#include "core/kernel/gather.h"
#include "core/kernel/nearest.h"
#include "integrators/photon_map/photon_map_params.h"
#include "integrators/photon_paths/hit_point.h"

BUFFER_RO(16, HitPointRecord, hits)
BUFFER_RW(17, vec4, gathered)
BUFFER_RO(18, PhotonMapParams, photon_map)

struct Gathered {
    HitPoint point;
    Nearest nearest;
};

FN float gather_limit(IN(Gathered) g) { return g.nearest.limit; }

FN Gathered gather_begin(uint query) {
    Gathered g;
    g.point = hit_point(hits[query]);
    float radius = queries[query].w;
    g.nearest = nearest_begin(uint(photon_map[0].nearest), radius * radius);
    return g;
}

FN void gather_add(INOUT(Gathered) g, uint query, IN(PhotonRecord) photon, float distance_squared, float weight) {
    if (distance_squared > g.nearest.limit || !hit_point_sees(g.point, -dot3(photon_direction(photon), g.point.ng)))
        return;
    nearest_add(g.nearest, photon, distance_squared);
}

// Required of every consumer, but not called: photon_map rejects maps that pass on only sums.
FN vec4 gather_value(uint query, IN(PhotonRecord) photon, float distance_squared) { return vec4(0.0f); }
FN Gathered gather_sums(uint query, vec4 sums) {
    Gathered g;
    g.point = no_hit_point();
    g.nearest = nearest_begin(0u, 0.0f);
    return g;
}

FN void gather_end(IN(Gathered) g, uint query) {
    float radius = queries[query].w;
    float whole = max(radius * radius, SMALLEST_RADIUS_SQUARED);
    float disk;
    uint count = nearest_end(g.nearest, whole, disk);
    // No smaller disk: below this radius the rounding error of the hit point matters.
    float least = hit_least_radius(hits[query]);
    disk = max(disk, least * least);
    vec4 sum = vec4(0.0f);
    uint i = 0u;
    for (; i < count; ++i) sum += hit_point_reflects(g.point, nearest_photon(i), 1.0f);
    if (i != count) REPORT_UNFINISHED();
    gathered[query] = sum * (whole / disk);
}

// Finds the nearest photons of each query, and nothing else: for tests.
#define GATHER_SHRINKS
#include "core/kernel/gather.h"
#include "core/kernel/nearest.h"
#include "accel/photons/collect/collect_layout.h"

BUFFER_RW(16, CollectResult, results)
BUFFER_RO(17, uvec4, wanted)  // x: number of photons

struct Gathered {
    Nearest nearest;
    float handed;  // photons that the structure passed on
};

FN float gather_limit(IN(Gathered) g) { return g.nearest.limit; }

FN Gathered gather_begin(uint query) {
    Gathered g;
    float radius = queries[query].w;
    g.nearest = nearest_begin(wanted[0].x, radius * radius);
    g.handed = 0.0f;
    return g;
}

FN void gather_add(INOUT(Gathered) g, uint query, IN(PhotonRecord) photon, float distance_squared, float weight) {
    g.handed += 1.0f;
    if (distance_squared <= g.nearest.limit) nearest_add(g.nearest, photon, distance_squared);
}

// Maps that only know sums cannot find the nearest photons.
FN vec4 gather_value(uint query, IN(PhotonRecord) photon, float distance_squared) { return vec4(0.0f); }
FN Gathered gather_sums(uint query, vec4 sums) { return gather_begin(query); }

FN void gather_end(IN(Gathered) g, uint query) {
    float radius = queries[query].w;
    float disk;
    uint count = nearest_end(g.nearest, radius * radius, disk);
    CollectResult r;
    r.sum = vec4(0.0f, disk, g.handed, float(g.nearest.count));
    r.found = uvec4(count, 0u, 0u, 0u);
    uint i = 0u;
    for (; i < count; ++i) {
        PhotonRecord photon = nearest_photon(i);
        r.found.y = 31u * r.found.y + photon.place.w;  // depends on the order, too
        r.sum.x += photon_power(photon)[0];
    }
    if (i != count) REPORT_UNFINISHED();
    results[query] = r;
}

// The photons nearest to a query, for consumers that look for them with any structure that hands over each photon in range.
#ifndef LAMPYRIS_KERNEL_NEAREST
#define LAMPYRIS_KERNEL_NEAREST

#include "core/kernel/photon.h"

// Most that one can ask for. One more is kept: the disk ends there.
CONST uint NEAREST_MOST = 256u;

// The invocation's own: a heap whose root is the farthest, once `places` photons are there. The order is that of (squared distance,
// key): the same set, however the structure hands photons over. Arrays in a struct would be copied by each call in GLSL.
PRIVATE(uvec3, nearest_items,
        NEAREST_MOST + 1u)  // squared distance (bits: they are in the order of floats >= 0), key, which flux
PRIVATE(uvec4, nearest_fluxes, NEAREST_MOST + 1u)

struct Nearest {
    uint places;
    uint count;
    float limit;  // squared distance beyond which no photon is wanted any more
};

FN bool nearest_before(uvec3 a, uvec3 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

// The item sinks into the heap of the first `count` from `root` on.
FN void nearest_sink(uint root, uint count, uvec3 item) {
    uint hole = root;
    // One level a step: the bound is never met, unless the driver ends the loop early.
    uint step = 0u;
    for (; step != 32u && 2u * hole + 1u < count; ++step) {
        uint child = 2u * hole + 1u;
        if (child + 1u < count && nearest_before(nearest_items[child], nearest_items[child + 1u])) child += 1u;
        if (!nearest_before(item, nearest_items[child])) break;
        nearest_items[hole] = nearest_items[child];
        hole = child;
    }
    nearest_items[hole] = item;
}

FN void nearest_heap(uint count) {
    for (uint left = count / 2u; left > 0u; --left) nearest_sink(left - 1u, count, nearest_items[left - 1u]);
}

// `photons`: how many to find; `radius_squared`: how far to look.
FN Nearest nearest_begin(uint photons, float radius_squared) {
    Nearest n;
    n.places = min(photons, NEAREST_MOST) + 1u;
    n.count = 0u;
    n.limit = max(radius_squared, SMALLEST_RADIUS_SQUARED);
    return n;
}

FN void nearest_add(INOUT(Nearest) n, IN(PhotonRecord) photon, float distance_squared) {
    uvec3 item = uvec3(floatBitsToUint(distance_squared), photon.place.w, n.count);
    if (n.count < n.places) {
        nearest_items[n.count] = item;
        nearest_fluxes[n.count] = photon.flux;
        n.count += 1u;
        if (n.count < n.places) return;
        nearest_heap(n.count);
    } else {
        if (!nearest_before(item, nearest_items[0u])) return;
        item.z = nearest_items[0u].z;
        nearest_fluxes[item.z] = photon.flux;
        nearest_sink(0u, n.count, item);
    }
    n.limit = uintBitsToFloat(nearest_items[0u].x);
}

// Call last: sorts what was found, nearest first. Returns how many photons to count, and the squared radius of the disk that they
// fill: the k nearest and the distance of the next; where there is none, all and the radius of the query.
//
// Counting k photons over the disk that ends at the next one (k - 1 over that of the k-th: Garcia Hernandez et al. 2012) is unbiased
// where photons are Poisson distributed with a constant density, whatever the radius of the query (docs/photon-maps.md).
FN uint nearest_end(IN(Nearest) n, float radius_squared, OUT(float) disk) {
    bool full = n.count == n.places;
    disk = max(full ? n.limit : radius_squared, SMALLEST_RADIUS_SQUARED);
    if (!full) nearest_heap(n.count);
    for (uint last = n.count; last > 1u; --last) {
        uvec3 item = nearest_items[last - 1u];
        nearest_items[last - 1u] = nearest_items[0u];
        nearest_sink(0u, last - 1u, item);
    }
    return full ? n.count - 1u : n.count;
}

// The i-th of the nearest: its key and flux. Where it lies is not kept.
FN PhotonRecord nearest_photon(uint i) {
    PhotonRecord photon;
    photon.place = uvec4(0u, 0u, 0u, nearest_items[i].y);
    photon.flux = nearest_fluxes[nearest_items[i].z];
    return photon;
}

#endif

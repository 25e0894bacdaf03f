// The photons nearest to a query, for consumers that use any structure that passes on every photon in range.
#ifndef LAMPYRIS_KERNEL_NEAREST
#define LAMPYRIS_KERNEL_NEAREST

#include "core/kernel/photon.h"

// Maximum number of photons. One more is kept, because the disk ends at it.
CONST uint NEAREST_MOST = 256u;

// Per invocation: a heap with the farthest photon at its root, once there are `places` photons. They are ordered by
// (squared distance, key), so that the set does not depend on the order in which the structure finds them. These arrays
// are not members of Nearest, because GLSL would copy them at every call. An item is the squared distance (bits, which
// have the order of floats >= 0), the key, and the index of the flux.
PRIVATE(uvec3, nearest_items, NEAREST_MOST + 1u)
PRIVATE(uvec4, nearest_fluxes, NEAREST_MOST + 1u)

struct Nearest {
    uint places;
    uint count;
    float limit;  // squared distance beyond which photons are ignored
};

FN bool nearest_before(uvec3 a, uvec3 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

// Sifts the item down from `root` in the heap of the first `count` items.
FN void nearest_sink(uint root, uint count, uvec3 item) {
    uint hole = root;
    // One level per step, so the bound is never reached.
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

// `photons`: how many to find, within the squared radius.
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

// Call last. Sorts the photons, nearest first. Returns how many of them to count, and the squared radius of the disk
// that they fill: the k nearest and the distance of the next one; if there is none, all of them and the query's radius.
//
// Counting k photons over the disk that ends at the next one (or k - 1 over that of the k-th: Garcia Hernandez et al.
// 2012) is unbiased if photons are Poisson distributed with constant density, for any query radius
// (docs/photon-maps.md).
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

// Key and flux of the i-th nearest photon. Its position is not kept.
FN PhotonRecord nearest_photon(uint i) {
    PhotonRecord photon;
    photon.place = uvec4(0u, 0u, 0u, nearest_items[i].y);
    photon.flux = nearest_fluxes[nearest_items[i].z];
    return photon;
}

#endif

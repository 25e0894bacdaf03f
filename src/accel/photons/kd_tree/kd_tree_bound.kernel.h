// Stores the photons of each large node contiguously, and computes their bounds.
#include "accel/photons/kd_tree/kd_tree_layout.h"

BUFFER_RO(0, KdArgs, arguments)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RO(2, uint, chunks)
BUFFER_RW(3, KdLarge, larges)
BUFFER_RO(4, uint, order)
BUFFER_RW(5, uvec4, places)
BUFFER_RW(6, uint, scratch)

KERNEL(kd_tree_bound) {
    uint count = arguments[0].count;
    uint chunk = index / 32u;
    uint large = chunks[chunk];
    uint begin = larges[large].photons.x + (chunk - larges[large].photons.z) * KD_CHUNK;
    uint end = min(begin + KD_CHUNK, larges[large].photons.x + larges[large].photons.y);
    if (begin + batch_item(index, 0u) - chunk * KD_CHUNK >= end) return;
    // Prefetches six batches ahead: an invocation's own batch is too short to hide the latency of memory.
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = begin + batch_item(index, k) - chunk * KD_CHUNK + 6u * BATCH;
        PREFETCH(photons[order[min(i, count - 1u)]].place);
    }
    vec3 low = vec3(3e38f);
    vec3 high = vec3(-3e38f);
    uint first_key = 0xffffffffu;
    uint last_key = 0u;
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = begin + batch_item(index, k) - chunk * KD_CHUNK;
        if (i >= end) continue;
        uvec4 place = photons[order[i]].place;
        places[i] = place;
        scratch[2u * count + i] = order[i];
        low = min(low, place_position(place));
        high = max(high, place_position(place));
        first_key = min(first_key, place.w);
        last_key = max(last_key, place.w);
    }
    uvec4 least = ~uvec4(kd_ordered(low.x), kd_ordered(low.y), kd_ordered(low.z), first_key);
    uvec4 greatest = uvec4(kd_ordered(high.x), kd_ordered(high.y), kd_ordered(high.z), last_key);
    // Most invocations find that the bounds already include theirs, and need no atomic.
    uvec4 known = larges[large].least;
    if (least.x > known.x) ATOMIC_MAX_U32(larges[large].least.x, least.x);
    if (least.y > known.y) ATOMIC_MAX_U32(larges[large].least.y, least.y);
    if (least.z > known.z) ATOMIC_MAX_U32(larges[large].least.z, least.z);
    if (least.w > known.w) ATOMIC_MAX_U32(larges[large].least.w, least.w);
    known = larges[large].greatest;
    if (greatest.x > known.x) ATOMIC_MAX_U32(larges[large].greatest.x, greatest.x);
    if (greatest.y > known.y) ATOMIC_MAX_U32(larges[large].greatest.y, greatest.y);
    if (greatest.z > known.z) ATOMIC_MAX_U32(larges[large].greatest.z, greatest.z);
    if (greatest.w > known.w) ATOMIC_MAX_U32(larges[large].greatest.w, greatest.w);
}

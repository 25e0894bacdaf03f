// Copies the photons in sorted order, positions separately from the rest. Runs with the same upper half of the code are
// sorted by the lower half, then by key, because the result must not depend on the order of storage. The invocation
// that has a run's first photon copies the run.
#include "accel/photons/bvh/bvh_layout.h"

BUFFER_RO(0, TreeRecord, tree)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RO(2, uvec2, pairs)
BUFFER_RW(3, uvec2, order)  // scratch memory for sorting long runs
BUFFER_RW(4, uvec4, places)
BUFFER_RW(5, uvec4, fluxes)
#include "core/kernel/sort.h"

CONST uint RUN_SHORT = 32u;  // runs of up to this many photons are sorted in registers

FN void bvh_copy(uint to, uint from) {
    places[to] = photons[from].place;
    fluxes[to] = photons[from].flux;
}

FN void bvh_short_run(uint begin, uint count) {
    uint codes[RUN_SHORT];
    uint keys[RUN_SHORT];
    for (uint n = 0u; n < count; ++n) {
        uvec4 place = photons[pairs[begin + n].y].place;
        codes[n] = morton_code(tree[0], place_position(place), 0u);
        keys[n] = place.w;
    }
    for (uint n = 0u; n < count; ++n) {
        uint rank = 0u;
        for (uint other = 0u; other < count; ++other)
            rank += uint(codes[other] < codes[n]) | (uint(codes[other] == codes[n]) & uint(keys[other] < keys[n]));
        bvh_copy(begin + rank, pairs[begin + n].y);
    }
}

FN void bvh_long_run(uint begin, uint end) {
    uint i = begin;
    for (; i < end; ++i) {
        uint photon = pairs[i].y;
        order[i] = uvec2(morton_code(tree[0], place_position(photons[photon].place), 0u), photon);
    }
    if (i != end) REPORT_UNFINISHED();
    sort_order(begin, end);
    // Photons whose lower halves are the same, too, are sorted by key.
    uint first = begin;
    uint next = begin + 1u;
    for (; next <= end; ++next) {
        if (next < end && order[next].x == order[first].x) continue;
        if (next - first > 1u) {
            for (uint k = first; k < next; ++k) order[k].x = photons[order[k].y].place.w;
            sort_order(first, next);
        }
        for (uint k = first; k < next; ++k) bvh_copy(k, order[k].y);
        first = next;
    }
    if (next != end + 1u) REPORT_UNFINISHED();
}

KERNEL(bvh_order) {
    uint count = tree[0].count;
    // Prefetches for the fourth invocation from here: for this one's own photons it would be too late.
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index + 4u, k);
        if (i < count) PREFETCH(photons[pairs[i].y]);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i >= count) continue;
        uint code = pairs[i].x;
        if (i > 0u && pairs[i - 1u].x == code) continue;
        uint end = i + 1u;
        for (; end < count && pairs[end].x == code; ++end) {}
        if (end != count && pairs[end].x == code) REPORT_UNFINISHED();
        if (end == i + 1u) {
            bvh_copy(i, pairs[i].y);
        } else if (end - i <= RUN_SHORT) {
            bvh_short_run(i, end - i);
        } else {
            bvh_long_run(i, end);
        }
    }
}

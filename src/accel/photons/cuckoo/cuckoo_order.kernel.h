// Copies the photons in sorted order, positions separately from the rest. Runs are sorted by key, because the result
// must not depend on the order of storage. The invocation that has a run's first photon marks the run's beginning and
// copies the run.
#include "accel/photons/cuckoo/cuckoo_layout.h"

BUFFER_RO(0, CuckooRecord, cuckoo)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RO(2, uvec2, pairs)
BUFFER_RW(3, uvec2, order)  // scratch memory for sorting long runs
BUFFER_RW(4, uint, runs)    // 1 for the first photon of a run, otherwise 0
BUFFER_RW(5, uvec4, places)
BUFFER_RW(6, uvec4, fluxes)
#include "core/kernel/sort.h"

CONST uint RUN_SHORT = 64u;  // runs of up to this many photons are sorted in registers

FN void cuckoo_copy(uint to, uint from) {
    places[to] = photons[from].place;
    fluxes[to] = photons[from].flux;
}

FN void cuckoo_short_run(uint begin, uint count) {
    uint keys[RUN_SHORT];
    for (uint n = 0u; n < count; ++n) keys[n] = photons[pairs[begin + n].y].place.w;
    for (uint n = 0u; n < count; ++n) {
        uint rank = 0u;
        for (uint other = 0u; other < count; ++other) rank += keys[other] < keys[n] ? 1u : 0u;
        cuckoo_copy(begin + rank, pairs[begin + n].y);
    }
}

FN void cuckoo_long_run(uint begin, uint end) {
    uint i = begin;
    for (; i < end; ++i) order[i] = uvec2(photons[pairs[i].y].place.w, pairs[i].y);
    if (i != end) REPORT_UNFINISHED();
    sort_order(begin, end);
    for (i = begin; i < end; ++i) cuckoo_copy(i, order[i].y);
    if (i != end) REPORT_UNFINISHED();
}

KERNEL(cuckoo_order) {
    uint count = cuckoo[0].grid.count;
    // Prefetches for the invocation after the next: for this one's own photons it would be too late.
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index + 2u, k);
        if (i < count) PREFETCH(photons[pairs[i].y]);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i >= count) continue;
        uint code = pairs[i].x;
        bool first = i == 0u || pairs[i - 1u].x != code;
        runs[i] = first ? 1u : 0u;
        if (!first) continue;
        uint end = i + 1u;
        for (; end < count && pairs[end].x == code; ++end) {}
        if (end != count && pairs[end].x == code) REPORT_UNFINISHED();
        if (end - i <= RUN_SHORT) {
            cuckoo_short_run(i, end - i);
        } else {
            cuckoo_long_run(i, end);
        }
    }
}

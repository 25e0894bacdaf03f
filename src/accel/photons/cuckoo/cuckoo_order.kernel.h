// Copies the photons in order, positions and the rest apart, each run's by key: the order must not depend on that of storage. The first of
// each run marks it, and does it.
#include "accel/photons/cuckoo/cuckoo_layout.h"

BUFFER_RO(0, CuckooRecord, cuckoo)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RO(2, uvec2, pairs)
BUFFER_RW(3, uvec2, order)  // room to sort a long run
BUFFER_RW(4, uint, runs)    // 1 where one begins
BUFFER_RW(5, uvec4, places)
BUFFER_RW(6, uvec4, fluxes)
#include "core/kernel/sort.h"

CONST uint RUN_SHORT = 64u;  // photons that are sorted in registers

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
    // What the invocation after the next will read: this one's own would come too late.
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

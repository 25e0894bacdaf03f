// Sorts the photons of each entry by key, so that sums have a fixed order, and copies them, positions separately from
// the rest.
#include "core/kernel/photon.h"

BUFFER_RO(0, PhotonGrid, grid)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RO(2, uint, starts)
BUFFER_RO(3, uvec2, pairs)  // key, photon
BUFFER_RW(4, uvec2, order)  // scratch memory for sorting entries with many photons
BUFFER_RW(5, uvec4, places)
BUFFER_RW(6, uvec4, fluxes)
#include "core/kernel/sort.h"

CONST uint ENTRY_SHORT = 64u;  // entries of up to this many photons are sorted in registers

FN void sorted_grid_copy(uint to, uint from) {
    places[to] = photons[from].place;
    fluxes[to] = photons[from].flux;
}

KERNEL(sorted_grid_order) {
    uint entries = grid[0].entries;
    // Prefetches for the invocation after the next: for this one's own photons it would be too late.
    for (uint k = 0u; k < BATCH; ++k) {
        uint entry = batch_item(index + 2u, k);
        if (entry >= entries) continue;
        uint end = min(starts[entry + 1u], starts[entry] + ENTRY_SHORT);
        for (uint i = starts[entry]; i < end; ++i) PREFETCH(photons[pairs[i].y]);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint entry = batch_item(index, k);
        if (entry >= entries) continue;
        uint begin = starts[entry];
        uint end = starts[entry + 1u];
        if (end - begin <= ENTRY_SHORT) {
            uint keys[ENTRY_SHORT];
            for (uint n = 0u; n < end - begin; ++n) keys[n] = pairs[begin + n].x;
            for (uint n = 0u; n < end - begin; ++n) {
                uint rank = 0u;
                for (uint other = 0u; other < end - begin; ++other) rank += keys[other] < keys[n] ? 1u : 0u;
                sorted_grid_copy(begin + rank, pairs[begin + n].y);
            }
            continue;
        }
        uint i = begin;
        for (; i < end; ++i) order[i] = pairs[i];
        if (i != end) REPORT_UNFINISHED();
        sort_order(begin, end);
        for (i = begin; i < end; ++i) sorted_grid_copy(i, order[i].y);
        if (i != end) REPORT_UNFINISHED();
    }
}

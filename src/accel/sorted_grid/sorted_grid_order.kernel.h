// Sorts the photons of each entry by key, so that sums have one order, and copies them: positions, and the rest.
#include "core/kernel/photon.h"

BUFFER_RO(0, PhotonGrid, grid)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RO(2, uint, starts)
BUFFER_RW(3, uvec4, places)
BUFFER_RW(4, uvec4, fluxes)
BUFFER_RW(5, uvec2, order)
#include "core/kernel/sort.h"

KERNEL(sorted_grid_order) {
    uint entries = grid[0].sizes.y;
    for (uint ahead = 0u; ahead < BATCH; ++ahead) {
        uint entry = batch_item(index, ahead);
        if (entry >= entries) continue;
        uint end = min(starts[entry + 1u], starts[entry] + 16u);
        for (uint i = starts[entry]; i < end; ++i) PREFETCH(photons[order[i].y].place);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint entry = batch_item(index, k);
        if (entry >= entries) continue;
        uint begin = starts[entry];
        uint end = starts[entry + 1u];
        sort_order(begin, end);
        uint i = begin;
        for (; i < end; ++i) {
            uint photon = order[i].y;
            places[i] = photons[photon].place;
            fluxes[i] = photons[photon].flux;
        }
        if (i != end) REPORT_UNFINISHED();
    }
}

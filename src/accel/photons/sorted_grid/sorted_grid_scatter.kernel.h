// Writes (key, photon index) to the photon's place within its table entry.
#include "core/kernel/photon.h"

BUFFER_RO(0, PhotonGrid, grid)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RO(2, uint, starts)
BUFFER_RO(3, uvec2, ranks)
BUFFER_RW(4, uvec2, order)

KERNEL(sorted_grid_scatter) {
    uint count = grid[0].count;
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i < count) PREFETCH(starts[ranks[i].x]);
    }
    uint places[BATCH];
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i >= count) continue;
        places[k] = starts[ranks[i].x] + ranks[i].y;
        PREFETCH(order[places[k]]);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i < count) order[places[k]] = uvec2(photons[i].place.w, i);
    }
}

// How many photons each entry gets, and which of them each photon is (in the order of the machine, which is not fixed).
#include "accel/sorted_grid/sorted_grid.layout.h"

BUFFER_RO(0, PhotonGrid, grid)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uint, starts)
BUFFER_RW(3, uvec2, ranks)

KERNEL(sorted_grid_count) {
    PhotonGrid g = grid[0];
    uint entries[BATCH];
    uint counts[BATCH];
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i >= g.sizes.x) continue;
        entries[k] = sorted_grid_entry(g, grid_cell(g, place_position(photons[i].place)));
        PREFETCH(starts[entries[k]]);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i < g.sizes.x) counts[k] = ATOMIC_ADD_U32(starts[entries[k]], 1u);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i < g.sizes.x) ranks[i] = uvec2(entries[k], counts[k]);
    }
}

// Counts the photons of each entry, and gives each photon its rank among them (in the order of execution, which is not
// fixed).
#include "core/kernel/span.h"
#include "accel/photons/sorted_grid/sorted_grid_layout.h"

BUFFER_RO(0, PhotonGrid, grid)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uint, starts)
BUFFER_RW(3, uvec2, ranks)

KERNEL(sorted_grid_count) {
    PhotonGrid g = grid[0];
    uint entries[2u * BATCH];
    uint counts[BATCH];
    for (uint turn = 0u; turn <= SPAN; ++turn) {
        for (uint k = 0u; k < BATCH && turn < SPAN; ++k) {
            uint i = span_item(index, turn, k);
            if (i >= g.count) continue;
            uint entry = sorted_grid_entry(g, grid_cell(g, place_position(photons[i].place)));
            entries[span_room(turn, k)] = entry;
            PREFETCH(starts[entry]);
        }
        // Atomics wait for earlier stores, so the stores are in a loop of their own.
        for (uint k = 0u; k < BATCH && turn > 0u; ++k) {
            if (span_item(index, turn - 1u, k) < g.count)
                counts[k] = ATOMIC_ADD_U32(starts[entries[span_room(turn - 1u, k)]], 1u);
        }
        for (uint k = 0u; k < BATCH && turn > 0u; ++k) {
            uint i = span_item(index, turn - 1u, k);
            if (i < g.count) ranks[i] = uvec2(entries[span_room(turn - 1u, k)], counts[k]);
        }
    }
}

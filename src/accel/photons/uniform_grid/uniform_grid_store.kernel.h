// Each photon takes the next slot of its cell. If there is none, it joins the list, or is dropped.
#include "core/kernel/span.h"
#include "accel/photons/uniform_grid/uniform_grid_layout.h"

BUFFER_RO(0, PhotonGrid, grid)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uint, counts)
BUFFER_RW(3, uvec4, slots)
BUFFER_RW(4, uint, keys)    // of the photons in the slots
BUFFER_RW(5, uvec4, nodes)  // of photons beyond the capacity: for now, key and link to the next
BUFFER_RW(6, uint, dropped)

KERNEL(uniform_grid_store) {
    PhotonGrid g = grid[0];
    uint cells[2u * BATCH];
    uint ranks[BATCH];
    for (uint turn = 0u; turn <= SPAN; ++turn) {
        for (uint k = 0u; k < BATCH && turn < SPAN; ++k) {
            uint i = span_item(index, turn, k);
            if (i >= g.count) continue;
            uint cell = uniform_grid_index(g, grid_cell(g, place_position(photons[i].place)));
            cells[span_room(turn, k)] = cell;
            PREFETCH(counts[2u * cell]);
        }
        // Atomics wait for earlier stores, so the stores are in a loop of their own.
        for (uint k = 0u; k < BATCH && turn > 0u; ++k) {
            if (span_item(index, turn - 1u, k) >= g.count) continue;
            uint cell = cells[span_room(turn - 1u, k)];
            ranks[k] = ATOMIC_ADD_U32(counts[2u * cell], 1u);
            uint slot = cell * g.capacity + min(ranks[k], g.capacity - 1u);
            PREFETCH(slots[slot]);
            PREFETCH(keys[slot]);
        }
        for (uint k = 0u; k < BATCH && turn > 0u; ++k) {
            uint i = span_item(index, turn - 1u, k);
            if (i >= g.count) continue;
            uvec4 place = photons[i].place;
            uint cell = cells[span_room(turn - 1u, k)];
            if (ranks[k] < g.capacity) {
                uint slot = cell * g.capacity + ranks[k];
                slots[slot] = uvec4(place.x, place.y, place.z, i);
                keys[slot] = place.w;
            } else if (g.option != 0u) {
                ATOMIC_ADD_U32(dropped[0], 1u);
            } else {
                nodes[i] = uvec4(place.w, ATOMIC_EXCHANGE_U32(counts[2u * cell + 1u], i + 1u), 0u, 0u);
            }
        }
    }
}

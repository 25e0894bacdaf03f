// Each photon becomes the head of its bucket's chain.
#include "core/kernel/photon_grid.h"
#include "core/kernel/span.h"

BUFFER_RO(0, PhotonGrid, grid)  // option: 1 if chains will be sorted
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uint, heads)   // a photon's index plus one; 0 ends a chain
BUFFER_RW(3, uvec2, links)  // key, link to the next
BUFFER_RW(4, uvec4, nodes)  // if chains will not be sorted: position, link to the next

KERNEL(linked_list_link) {
    PhotonGrid g = grid[0];
    uint buckets[2u * BATCH];
    for (uint turn = 0u; turn <= SPAN; ++turn) {
        for (uint k = 0u; k < BATCH && turn < SPAN; ++k) {
            uint i = span_item(index, turn, k);
            if (i >= g.count) continue;
            uint bucket = grid_entry(g, grid_cell(g, place_position(photons[i].place)));
            buckets[span_room(turn, k)] = bucket;
            PREFETCH(heads[bucket]);
        }
        for (uint k = 0u; k < BATCH && turn > 0u; ++k) {
            uint i = span_item(index, turn - 1u, k);
            if (i >= g.count) continue;
            uvec4 place = photons[i].place;
            uint next = ATOMIC_EXCHANGE_U32(heads[buckets[span_room(turn - 1u, k)]], i + 1u);
            if (g.option != 0u) {
                links[i] = uvec2(place.w, next);
            } else {
                nodes[i] = uvec4(place.x, place.y, place.z, next);
            }
        }
    }
}

// Writes the nodes: each photon's position and its link, which now has its final value.
#include "core/kernel/photon_grid.h"

BUFFER_RO(0, PhotonGrid, grid)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RO(2, uvec2, links)
BUFFER_RW(3, uvec4, nodes)

KERNEL(linked_list_place) {
    uint count = grid[0].count;
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i >= count) continue;
        uvec4 place = photons[i].place;
        nodes[i] = uvec4(place.x, place.y, place.z, links[i].y);
    }
}

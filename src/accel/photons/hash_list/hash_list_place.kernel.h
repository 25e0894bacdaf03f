// The same thread writes the nodes, CHUNK per invocation.
#include "core/kernel/photon_grid.h"

BUFFER_RO(0, PhotonGrid, grid)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RO(2, uvec2, links)
BUFFER_RW(3, uvec4, nodes)

CONST uint CHUNK = 4096u;

KERNEL(hash_list_place) {
    uint end = min((index + 1u) * CHUNK, grid[0].count);
    uint i = index * CHUNK;
    for (; i < end; ++i) {
        uvec4 place = photons[i].place;
        nodes[i] = uvec4(place.x, place.y, place.z, links[i].y);
    }
    if (i != end) REPORT_UNFINISHED();
}

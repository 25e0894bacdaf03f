// One thread links one photon after another: invocations run one at a time, each for CHUNK photons (hash_list.cpp).
#include "core/kernel/photon_grid.h"

BUFFER_RO(0, PhotonGrid, grid)  // all buffers as in linked_list_link.kernel.h
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uint, heads)
BUFFER_RW(3, uvec2, links)
BUFFER_RW(4, uvec4, nodes)

CONST uint CHUNK = 4096u;

KERNEL(hash_list_insert) {
    PhotonGrid g = grid[0];
    uint end = min((index + 1u) * CHUNK, g.count);
    uint begin = index * CHUNK;
    for (; begin < end; begin += min(BATCH, end - begin)) {
        uint buckets[BATCH];
        uint count = min(BATCH, end - begin);
        for (uint k = 0u; k < count; ++k) {
            buckets[k] = grid_entry(g, grid_cell(g, place_position(photons[begin + k].place)));
            PREFETCH(heads[buckets[k]]);
        }
        for (uint k = 0u; k < count; ++k) {
            uvec4 place = photons[begin + k].place;
            if (g.option != 0u) {
                links[begin + k] = uvec2(place.w, heads[buckets[k]]);
            } else {
                nodes[begin + k] = uvec4(place.x, place.y, place.z, heads[buckets[k]]);
            }
            heads[buckets[k]] = begin + k + 1u;
        }
    }
    if (begin != end) REPORT_UNFINISHED();
}

// The same thread sorts the chains by key, CHUNK buckets an invocation: fewer than when it links, since a chain takes many steps
// and Mesa 22 allows 65,535.
#include "core/kernel/photon_grid.h"

BUFFER_RO(0, PhotonGrid, grid)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uint, heads)
BUFFER_RW(3, uvec4, nodes)
#include "accel/linked_list/linked_list_sort.layout.h"

CONST uint CHUNK = 1024u;

KERNEL(hash_list_order) {
    uint end = min((index + 1u) * CHUNK, grid[0].sizes.y);
    uint b = index * CHUNK;
    for (; b < end; ++b) {
        uint ahead = min(b + 8u, end - 1u);
        if (heads[ahead] != 0u) PREFETCH(nodes[heads[ahead] - 1u]);
        if (heads[b] != 0u && nodes[heads[b] - 1u].w != 0u) heads[b] = chain_sort(heads[b]);
    }
    if (b != end) REPORT_UNFINISHED();
}

// Sorts each chain by key: exchanges came in no fixed order.
#include "core/kernel/photon_grid.h"

BUFFER_RO(0, PhotonGrid, grid)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uint, heads)
BUFFER_RW(3, uvec4, nodes)
#include "accel/linked_list/linked_list_sort.layout.h"

KERNEL(linked_list_order) {
    uint buckets = grid[0].sizes.y;
    uint second[BATCH];
    for (uint k = 0u; k < BATCH; ++k) {
        uint b = batch_item(index, k);
        if (b < buckets && heads[b] != 0u) PREFETCH(nodes[heads[b] - 1u]);
    }
    // A chain of one is sorted: only of others are keys read.
    for (uint k = 0u; k < BATCH; ++k) {
        uint b = batch_item(index, k);
        second[k] = b < buckets && heads[b] != 0u ? nodes[heads[b] - 1u].w : 0u;
        if (second[k] == 0u) continue;
        PREFETCH(nodes[second[k] - 1u]);
        PREFETCH(photons[second[k] - 1u].place);
        PREFETCH(photons[heads[b] - 1u].place);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint b = batch_item(index, k);
        if (second[k] != 0u) heads[b] = chain_sort(heads[b]);
    }
}

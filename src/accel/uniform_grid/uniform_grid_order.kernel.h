// Sorts each cell's photons by key, slots and list together: who came first is not fixed.
#include "accel/uniform_grid/uniform_grid.layout.h"

BUFFER_RO(0, PhotonGrid, grid)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uint, counts)
BUFFER_RW(3, uvec4, slots)
BUFFER_RW(4, uvec4, nodes)
#include "accel/linked_list/linked_list_sort.layout.h"

CONST uint MOST_SLOTS = 16u;

FN void uniform_grid_sort(uint first, uint count) {
    uint keys[MOST_SLOTS];
    uvec4 items[MOST_SLOTS];
    for (uint s = 0u; s < count; ++s) PREFETCH(photons[slots[first + s].w].place);
    for (uint s = 0u; s < count; ++s) {
        uvec4 item = slots[first + s];
        uint key = photons[item.w].place.w;
        uint hole = s;
        for (; hole > 0u && keys[hole - 1u] > key; --hole) {
            keys[hole] = keys[hole - 1u];
            items[hole] = items[hole - 1u];
        }
        keys[hole] = key;
        items[hole] = item;
    }
    for (uint s = 0u; s < count; ++s) slots[first + s] = items[s];
}

KERNEL(uniform_grid_order) {
    PhotonGrid g = grid[0];
    for (uint k = 0u; k < BATCH; ++k) {
        uint cell = batch_item(index, k);
        if (cell >= g.sizes.y) continue;
        uint count = counts[2u * cell];
        uint first = cell * g.sizes.z;
        if (count < 2u) continue;
        if (count <= g.sizes.z || g.sizes.w != 0u) {
            uniform_grid_sort(first, min(count, g.sizes.z));
            continue;
        }
        uint head = counts[2u * cell + 1u];
        for (uint s = 0u; s < g.sizes.z; ++s) {
            uvec4 slot = slots[first + s];
            nodes[slot.w] = uvec4(slot.x, slot.y, slot.z, head);
            head = slot.w + 1u;
        }
        head = chain_sort(head);
        for (uint s = 0u; s < g.sizes.z; ++s) {
            uvec4 node = nodes[head - 1u];
            slots[first + s] = uvec4(node.x, node.y, node.z, head - 1u);
            head = node.w;
        }
        counts[2u * cell + 1u] = head;
    }
}

// Sorts each cell's photons by key, slots and list together, because the order of arrival is not fixed.
#include "accel/photons/uniform_grid/uniform_grid_layout.h"

BUFFER_RO(0, PhotonGrid, grid)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uint, counts)
BUFFER_RW(3, uvec4, slots)
BUFFER_RO(4, uint, keys)
BUFFER_RW(5, uvec4, links)  // the nodes: key and link until they are sorted, then position and link
#include "accel/photons/linked_list/linked_list_sort.h"

CONST uint CELL_SHORT = 32u;  // cells of up to this many photons are sorted in registers

// Sorts a cell of `count` photons, at most CELL_SHORT. Those without a slot are read from the list.
FN void uniform_grid_sort(IN(PhotonGrid) g, uint cell, uint count) {
    uint first = cell * g.capacity;
    uint held = min(count, g.capacity);
    uvec4 items[CELL_SHORT];
    uint item_keys[CELL_SHORT];
    uint order[CELL_SHORT];
    for (uint s = 0u; s < held; ++s) {
        items[s] = slots[first + s];
        item_keys[s] = keys[first + s];
    }
    uint link = count > held ? counts[2u * cell + 1u] : 0u;
    for (uint s = held; s < count; ++s) {
        uvec4 place = photons[link - 1u].place;
        items[s] = uvec4(place.x, place.y, place.z, link - 1u);
        item_keys[s] = place.w;
        link = links[link - 1u].y;
    }
    for (uint s = 0u; s < count; ++s) {
        uint rank = 0u;
        for (uint other = 0u; other < count; ++other) rank += item_keys[other] < item_keys[s] ? 1u : 0u;
        order[rank] = s;
        if (rank < held) slots[first + rank] = items[s];
    }
    if (count == held) return;
    for (uint rank = count; rank > held; --rank) {
        uvec4 item = items[order[rank - 1u]];
        links[item.w] = uvec4(item.x, item.y, item.z, link);
        link = item.w + 1u;
    }
    counts[2u * cell + 1u] = link;
}

// Sorts a cell of any number of photons greater than the capacity: all become one chain.
FN void uniform_grid_sort_long(IN(PhotonGrid) g, uint cell) {
    uint first = cell * g.capacity;
    uint head = counts[2u * cell + 1u];
    for (uint s = 0u; s < g.capacity; ++s) {
        uint photon = slots[first + s].w;
        links[photon] = uvec4(keys[first + s], head, 0u, 0u);
        head = photon + 1u;
    }
    head = chain_merge_sort(head);
    for (uint s = 0u; s < g.capacity; ++s) {
        uvec4 place = photons[head - 1u].place;
        slots[first + s] = uvec4(place.x, place.y, place.z, head - 1u);
        head = links[head - 1u].y;
    }
    counts[2u * cell + 1u] = head;
    uint steps = 0u;
    for (; head != 0u && steps < g.count; ++steps) {
        uvec4 place = photons[head - 1u].place;
        uint next = links[head - 1u].y;
        links[head - 1u] = uvec4(place.x, place.y, place.z, next);
        head = next;
    }
    if (head != 0u) REPORT_UNFINISHED();
}

KERNEL(uniform_grid_order) {
    PhotonGrid g = grid[0];
    bool lists = g.option == 0u;
    for (uint k = 0u; k < BATCH; ++k) {
        uint cell = batch_item(index, k);
        if (cell >= g.entries || counts[2u * cell] <= g.capacity || !lists) continue;
        uint head = counts[2u * cell + 1u];
        PREFETCH(links[head - 1u]);
        PREFETCH(photons[head - 1u].place);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint cell = batch_item(index, k);
        if (cell >= g.entries) continue;
        uint count = counts[2u * cell];
        if (!lists) count = min(count, g.capacity);
        if (count > CELL_SHORT) {
            uniform_grid_sort_long(g, cell);
        } else if (count > 1u) {
            uniform_grid_sort(g, cell, count);
        }
    }
}

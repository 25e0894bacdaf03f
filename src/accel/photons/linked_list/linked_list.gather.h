// Traverses the chains of the cells that a query's box overlaps, several in turns: one alone would wait for memory at
// every node.
#include "core/kernel/gather.h"
#include "core/kernel/photon_grid.h"

BUFFER_RO(1, PhotonGrid, grid)
BUFFER_RO(2, uint, heads)
BUFFER_RO(3, uvec4, nodes)
BUFFER_RO(4, PhotonRecord, photons)

CONST uint CHAINS = 8u;

// Visits cells [first, first + CHAINS) of the box, counted row by row. Returns false if the driver ended a loop early.
FN bool linked_list_chains(IN(PhotonGrid) g, vec4 q, uvec3 low, uvec3 size, uint first, uint query,
                           INOUT(Gathered) gathered) {
    uint links[CHAINS];
    uvec3 cells[CHAINS];
    uint alive = 0u;
    uint count = min(CHAINS, size.x * size.y * size.z - first);
    for (uint k = 0u; k < count; ++k) {
        uint row = (first + k) / size.x;
        cells[k] = low + uvec3(first + k - row * size.x, row % size.y, row / size.y);
        links[k] = grid_entry(g, cells[k]);
        PREFETCH(heads[links[k]]);
    }
    for (uint k = 0u; k < count; ++k) {
        links[k] = heads[links[k]];
        if (links[k] == 0u) continue;
        PREFETCH(nodes[links[k] - 1u]);
        // Only chains that are not empty are kept; later, the last chain replaces one that ends.
        links[alive] = links[k];
        cells[alive] = cells[k];
        alive += 1u;
    }
    uint steps = 0u;
    for (; alive > 0u && steps < g.count; ++steps) {
        uint k = 0u;
        while (k < alive) {
            uint photon = links[k] - 1u;
            uvec4 place = nodes[photon];
            uvec3 cell = cells[k];
            if (place.w == 0u) {
                alive -= 1u;
                links[k] = links[alive];
                cells[k] = cells[alive];
            } else {
                links[k] = place.w;
                PREFETCH(nodes[place.w - 1u]);
                k += 1u;
            }
            float d2;
            if (!in_range(place_position(place), vec3(q), q.w, d2)) continue;
            // Two visited cells may share a bucket: each photon counts only in its own cell.
            if (!same_cell(grid_cell(g, place_position(place)), cell)) continue;
            gather_add(gathered, query, photons[photon], d2, 1.0f);
        }
    }
    return alive == 0u;
}

KERNEL(linked_list) {
    vec4 q = queries[index];
    if (q.w < 0.0f) return;
    Gathered gathered = gather_begin(index);
    PhotonGrid g = grid[0];
    vec3 reach = vec3(range_reach(q.w));
    uvec3 low = grid_cell(g, vec3(q) - reach);
    uvec3 size = grid_cell(g, vec3(q) + reach) - low + uvec3(1u);
    uint cells = size.x * size.y * size.z;
    uint groups = (cells + CHAINS - 1u) / CHAINS;
    uint group = 0u;
    bool finished = true;
    for (; group < groups; ++group)
        if (!linked_list_chains(g, q, low, size, group * CHAINS, index, gathered)) finished = false;
    if (group != groups || !finished) REPORT_UNFINISHED();
    gather_end(gathered, index);
}

// Reads the slots, and the list, of each cell that a query's box overlaps. Cells are not hashed, so none is visited
// twice.
#include "core/kernel/gather.h"
#include "accel/photons/uniform_grid/uniform_grid_layout.h"

BUFFER_RO(1, PhotonGrid, grid)
BUFFER_RO(2, uvec2, counts)
BUFFER_RO(3, uvec4, slots)
BUFFER_RO(4, uvec4, nodes)
BUFFER_RO(5, PhotonRecord, photons)

FN void uniform_grid_cell(IN(PhotonGrid) g, vec4 q, uint cell, uint query, INOUT(Gathered) gathered) {
    uvec2 count = counts[cell];
    uint held = min(count.x, g.capacity);
    uint first = cell * g.capacity;
    float weight = g.option != 0u && held > 0u ? float(count.x) / float(held) : 1.0f;
    for (uint s = 0u; s < held; ++s) {
        uvec4 slot = slots[first + s];
        float d2;
        if (in_range(place_position(slot), vec3(q), q.w, d2)) gather_add(gathered, query, photons[slot.w], d2, weight);
    }
    uint link = count.y;
    uint steps = 0u;
    for (; link != 0u && steps < g.count; ++steps) {
        uint photon = link - 1u;
        uvec4 node = nodes[photon];
        link = node.w;
        float d2;
        if (in_range(place_position(node), vec3(q), q.w, d2)) gather_add(gathered, query, photons[photon], d2, 1.0f);
    }
    if (link != 0u) REPORT_UNFINISHED();
}

KERNEL(uniform_grid) {
    vec4 q = queries[index];
    if (q.w < 0.0f) return;
    Gathered gathered = gather_begin(index);
    PhotonGrid g = grid[0];
    vec3 reach = vec3(range_reach(q.w));
    uvec3 low = grid_cell(g, vec3(q) - reach);
    uvec3 size = grid_cell(g, vec3(q) + reach) - low + uvec3(1u);
    uint cells = size.x * size.y * size.z;
    for (uint c = 0u; c < min(cells, 32u); ++c) {
        uint row = c / size.x;
        uint cell = uniform_grid_index(g, low + uvec3(c - row * size.x, row % size.y, row / size.y));
        PREFETCH(counts[cell]);
        PREFETCH(slots[cell * g.capacity]);
    }
    uint c = 0u;
    for (; c < cells; ++c) {
        uint row = c / size.x;
        uniform_grid_cell(g, q, uniform_grid_index(g, low + uvec3(c - row * size.x, row % size.y, row / size.y)), index,
                          gathered);
    }
    if (c != cells) REPORT_UNFINISHED();
    gather_end(gathered, index);
}

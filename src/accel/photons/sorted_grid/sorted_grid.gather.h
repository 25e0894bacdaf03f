// Visits the cells that a query's box overlaps, row by row: the photons of a row are contiguous.
#include "core/kernel/gather.h"
#include "accel/photons/sorted_grid/sorted_grid_layout.h"

BUFFER_RO(1, PhotonGrid, grid)
BUFFER_RO(2, uint, starts)
BUFFER_RO(3, uvec4, places)
BUFFER_RO(4, uvec4, fluxes)

// Gathers the photons of [begin, end) that are in range and in the cells low.x to high.x of the row (low.y, low.z).
// Other cells may share the table entries.
FN void sorted_grid_range(IN(PhotonGrid) g, vec4 q, uvec3 low, uvec3 high, uint begin, uint end, uint query,
                          INOUT(Gathered) gathered) {
    uint i = begin;
    for (; i < end; ++i) {
        uvec4 place = places[i];
        float d2;
        if (!in_range(place_position(place), vec3(q), q.w, d2)) continue;
        uvec3 cell = grid_cell(g, place_position(place));
        if (cell.x < low.x || cell.x > high.x || cell.y != low.y || cell.z != low.z) continue;
        PhotonRecord photon;
        photon.place = place;
        photon.flux = fluxes[i];
        gather_add(gathered, query, photon, d2, 1.0f);
    }
    if (i != end) REPORT_UNFINISHED();
}

KERNEL(sorted_grid) {
    vec4 q = queries[index];
    if (q.w < 0.0f) return;
    Gathered gathered = gather_begin(index);
    PhotonGrid g = grid[0];
    vec3 reach = vec3(range_reach(q.w));
    uvec3 low = grid_cell(g, vec3(q) - reach);
    uvec3 high = grid_cell(g, vec3(q) + reach);
    uint entries = g.entries;
    uint z = low.z;
    for (; z <= high.z; ++z) {
        uint y = low.y;
        for (; y <= high.y; ++y) {
            // A row wraps around at the end of the table. If it is longer than the table, it still visits each entry
            // once.
            uint first = sorted_grid_entry(g, uvec3(low.x, y, z));
            uint length = min(high.x - low.x + 1u, entries);
            uint before = min(length, entries - first);
            uvec3 from = uvec3(low.x, y, z);
            sorted_grid_range(g, q, from, high, starts[first], starts[first + before], index, gathered);
            if (before < length) sorted_grid_range(g, q, from, high, 0u, starts[length - before], index, gathered);
        }
        if (y != high.y + 1u) REPORT_UNFINISHED();
    }
    if (z != high.z + 1u) REPORT_UNFINISHED();
    gather_end(gathered, index);
}

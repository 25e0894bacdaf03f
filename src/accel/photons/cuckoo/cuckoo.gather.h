// Looks up the run of each cell that a query's box overlaps, in at most four table entries, and in the stash if it is
// not empty.
#include "core/kernel/gather.h"
#include "accel/photons/cuckoo/cuckoo_layout.h"

BUFFER_RO(1, CuckooRecord, cuckoo)
BUFFER_RO(2, uint, table)
BUFFER_RO(3, uint, stash)
BUFFER_RO(4, uvec2, cells)
BUFFER_RO(5, uvec4, places)
BUFFER_RO(6, uvec4, fluxes)

// The index of the cell's run plus one, or 0 if the cell has no photons.
FN uint cuckoo_find(IN(CuckooRecord) c, uint key) {
    for (uint way = 0u; way < CUCKOO_WAYS; ++way) {
        uint item = table[cuckoo_entry(c, key, way)];
        // Entries are never emptied, so no cell that has an entry lies behind an empty one. A stashed cell may.
        if (item == 0u) break;
        if (cells[item - 1u].x == key) return item;
    }
    uint stashed = min(stash[0], c.stash);
    for (uint i = 0u; i < stashed; ++i)
        if (cells[stash[1u + i] - 1u].x == key) return stash[1u + i];
    return 0u;
}

KERNEL(cuckoo) {
    vec4 q = queries[index];
    if (q.w < 0.0f) return;
    Gathered gathered = gather_begin(index);
    CuckooRecord c = cuckoo[0];
    PhotonGrid g = c.grid;
    vec3 reach = vec3(range_reach(q.w));
    uvec3 low = grid_cell(g, vec3(q) - reach);
    uvec3 size = grid_cell(g, vec3(q) + reach) - low + uvec3(1u);
    uint count = size.x * size.y * size.z;
    for (uint n = 0u; n < min(count, 32u); ++n) {
        uint row = n / size.x;
        uvec3 cell = low + uvec3(n - row * size.x, row % size.y, row / size.y);
        PREFETCH(table[cuckoo_entry(c, cuckoo_key(g, cell), 0u)]);
    }
    uint n = 0u;
    for (; n < count; ++n) {
        uint row = n / size.x;
        uvec3 cell = low + uvec3(n - row * size.x, row % size.y, row / size.y);
        uint item = cuckoo_find(c, cuckoo_key(g, cell));
        if (item == 0u) continue;
        uint end = cells[item].y;
        uint i = cells[item - 1u].y;
        for (; i < end; ++i) {
            uvec4 place = places[i];
            float d2;
            if (!in_range(place_position(place), vec3(q), q.w, d2)) continue;
            if (!same_cell(grid_cell(g, place_position(place)), cell)) continue;
            PhotonRecord photon;
            photon.place = place;
            photon.flux = fluxes[i];
            gather_add(gathered, index, photon, d2, 1.0f);
        }
        if (i != end) REPORT_UNFINISHED();
    }
    if (n != count) REPORT_UNFINISHED();
    gather_end(gathered, index);
}

// Counts the hit points of each entry, and gives each hit point its rank among them.
#include "accel/photons/splat/splat_layout.h"

BUFFER_RO(0, SplatRecord, splat)
BUFFER_RO(1, vec4, hits)  // position, radius; a negative radius finds nothing
BUFFER_RW(2, uint, starts)
BUFFER_RW(3, uvec2, ranks)

KERNEL(splat_count) {
    PhotonGrid g = splat[0].grid;
    uint entries[BATCH];
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i >= g.count) continue;
        entries[k] = splat_entry(g, grid_cell(g, vec3(hits[i])));
        PREFETCH(starts[entries[k]]);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i < g.count && hits[i].w >= 0.0f) ranks[i] = uvec2(entries[k], ATOMIC_ADD_U32(starts[entries[k]], 1u));
    }
}

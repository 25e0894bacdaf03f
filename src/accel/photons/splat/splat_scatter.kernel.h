// Writes each hit point to its place within its table entry.
#include "accel/photons/splat/splat_layout.h"

BUFFER_RO(0, SplatRecord, splat)
BUFFER_RO(1, vec4, hits)
BUFFER_RO(2, uint, starts)
BUFFER_RO(3, uvec2, ranks)
BUFFER_RW(4, vec4, sorted)
BUFFER_RW(5, uint, ids)

KERNEL(splat_scatter) {
    uint count = splat[0].grid.count;
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i >= count || hits[i].w < 0.0f) continue;
        uint place = starts[ranks[i].x] + ranks[i].y;
        sorted[place] = hits[i];
        ids[place] = i;
    }
}

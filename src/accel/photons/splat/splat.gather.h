// Each photon adds to the sums of the hit points in whose range it is: in fixed point, because atomics happen in no
// fixed order. The consumer's four sums (gather_value) become 64-bit integers; splat_finish converts them back.
#include "core/kernel/gather.h"
#include "accel/photons/splat/splat_layout.h"

BUFFER_RO(1, SplatRecord, splat)
BUFFER_RO(2, uint, starts)
BUFFER_RO(3, vec4, sorted)
BUFFER_RO(4, uint, ids)
BUFFER_RO(5, PhotonRecord, photons)
BUFFER_RW(6, uint64, sums)

// Adds a rounded contribution to a sum. It is never negative, and clamped far below what would overflow.
FN void splat_add(uint place, float value, float scale) {
    float fixed_point = floor(min(value * scale, 1e15f) + 0.5f);
    if (fixed_point > 0.0f) ATOMIC_ADD_U64(sums[place], uint64(fixed_point));
}

FN void splat_range(IN(SplatRecord) s, IN(PhotonRecord) photon, uvec3 low, uvec3 high, uint begin, uint end) {
    uint i = begin;
    for (; i < end; ++i) {
        vec4 hit = sorted[i];
        float d2;
        if (!in_range(photon_position(photon), vec3(hit), hit.w, d2)) continue;
        uvec3 cell = grid_cell(s.grid, vec3(hit));
        if (cell.x < low.x || cell.x > high.x || cell.y != low.y || cell.z != low.z) continue;
        uint query = ids[i];
        vec4 value = gather_value(query, photon, d2);
        splat_add(4u * query, value.x, s.scale.x);
        splat_add(4u * query + 1u, value.y, s.scale.y);
        splat_add(4u * query + 2u, value.z, s.scale.z);
        splat_add(4u * query + 3u, value.w, s.scale.w);
    }
    if (i != end) REPORT_UNFINISHED();
}

KERNEL(splat) {
    SplatRecord s = splat[0];
    PhotonGrid g = s.grid;
    PhotonRecord photon = photons[index];
    vec3 position = photon_position(photon);
    vec3 reach = vec3(s.reach.x);
    uvec3 low = grid_cell(g, position - reach);
    uvec3 high = grid_cell(g, position + reach);
    uint z = low.z;
    for (; z <= high.z; ++z) {
        uint y = low.y;
        for (; y <= high.y; ++y) {
            // Rows wrap around as in sorted_grid.gather.h.
            uvec3 from = uvec3(low.x, y, z);
            uint first = splat_entry(g, from);
            uint length = min(high.x - low.x + 1u, g.entries);
            uint before = min(length, g.entries - first);
            splat_range(s, photon, from, high, starts[first], starts[first + before]);
            if (before < length) splat_range(s, photon, from, high, 0u, starts[length - before]);
        }
        if (y != high.y + 1u) REPORT_UNFINISHED();
    }
    if (z != high.z + 1u) REPORT_UNFINISHED();
}

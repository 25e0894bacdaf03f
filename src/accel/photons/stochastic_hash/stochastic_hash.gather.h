// Reads the bucket of each cell that a query's box overlaps; the photons kept there represent all that fell into it.
#include "core/kernel/gather.h"
#include "accel/photons/stochastic_hash/stochastic_hash_layout.h"

BUFFER_RO(1, StochasticHash, hash)
BUFFER_RO(2, uvec2, table)  // low and high half of each word
BUFFER_RO(3, PhotonRecord, photons)

KERNEL(stochastic_hash) {
    vec4 q = queries[index];
    if (q.w < 0.0f) return;
    Gathered gathered = gather_begin(index);
    PhotonGrid g = hash[0].grid;
    bool by_flux = hash[0].selection == SELECT_FLUX;
    uint slots = g.capacity;
    vec3 reach = vec3(range_reach(q.w));
    uvec3 low = grid_cell(g, vec3(q) - reach);
    uvec3 high = grid_cell(g, vec3(q) + reach);
    uint z = low.z;
    for (; z <= high.z; ++z) {
        uint y = low.y;
        for (; y <= high.y; ++y) {
            uint row = row_hash(y, z, g.resolution.w);
            uint x = low.x;
            for (; x <= high.x; ++x) {
                uint bucket = (slots + 1u) * hashed_entry(cell_hash(row, x), g.entries);
                uvec2 total = table[bucket];
                if (total.x == 0u && total.y == 0u) continue;
                uint kept = by_flux ? 1u : min(total.x, slots);
                for (uint slot = 1u; slot <= kept; ++slot) {
                    PhotonRecord photon = photons[table[bucket + slot].x];
                    float d2;
                    if (!in_range(photon_position(photon), vec3(q), q.w, d2)) continue;
                    // Two visited cells may share a bucket: each photon counts only in its own cell.
                    if (!same_cell(grid_cell(g, photon_position(photon)), uvec3(x, y, z))) continue;
                    float weight = float(total.x) / float(kept);
                    if (by_flux)
                        weight = (float(total.y) * 4294967296.0f + float(total.x)) /
                                 float(flux_weight(photon, hash[0].flux_scale));
                    gather_add(gathered, index, photon, d2, weight);
                }
            }
            if (x != high.x + 1u) REPORT_UNFINISHED();
        }
        if (y != high.y + 1u) REPORT_UNFINISHED();
    }
    if (z != high.z + 1u) REPORT_UNFINISHED();
    gather_end(gathered, index);
}

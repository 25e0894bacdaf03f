// The photon with the smallest -log(u) / w stays, so that each has the probability w / (sum of w in the bucket)
// (Efraimidis and Spirakis 2006). Positive floats have the same order as their bits. Ties (1 in 10^7 pairs) are decided
// by the order of storage.
#include "core/kernel/span.h"
#include "accel/photons/stochastic_hash/stochastic_hash_layout.h"

BUFFER_RO(0, StochasticHash, hash)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uint64, table)

KERNEL(stochastic_hash_flux) {
    PhotonGrid g = hash[0].grid;
    uint buckets[2u * BATCH];
    for (uint turn = 0u; turn <= SPAN; ++turn) {
        for (uint k = 0u; k < BATCH && turn < SPAN; ++k) {
            uint i = span_item(index, turn, k);
            if (i >= g.count) continue;
            uint bucket = 2u * grid_entry(g, grid_cell(g, place_position(photons[i].place)));
            buckets[span_room(turn, k)] = bucket;
            PREFETCH(table[bucket]);
        }
        for (uint k = 0u; k < BATCH && turn > 0u; ++k) {
            uint i = span_item(index, turn - 1u, k);
            if (i >= g.count) continue;
            uint bucket = buckets[span_room(turn - 1u, k)];
            PhotonRecord photon = photons[i];
            uint w = flux_weight(photon, hash[0].flux_scale);
            float u = (float(photon_priority(photon.place.w, g.option) >> 8u) + 0.5f) * 5.9604644775390625e-8f;
            uint rank = 0xffffffffu - floatBitsToUint(-log_of(u) / float(w));
            ATOMIC_ADD_U64(table[bucket], uint64(w));
            ATOMIC_MAX_U64(table[bucket + 1u], (uint64(rank) << 32) | uint64(i));
        }
    }
}

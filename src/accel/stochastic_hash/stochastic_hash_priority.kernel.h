// Each photon's priority is a hash of its path: the largest of a bucket stay, whoever comes first. One atomic maximum decides, and with
// several slots what it displaces goes on to the next slot.
#include "accel/stochastic_hash/stochastic_hash.layout.h"

BUFFER_RO(0, StochasticHash, hash)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uint64, table)

KERNEL(stochastic_hash_priority) {
    PhotonGrid g = hash[0].grid;
    uint slots = g.sizes.z;
    uint buckets[BATCH];
    uint priorities[BATCH];
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i >= g.sizes.x) continue;
        uvec4 place = photons[i].place;
        buckets[k] = (slots + 1u) * grid_entry(g, grid_cell(g, place_position(place)));
        priorities[k] = photon_priority(place.w, g.sizes.w);
        PREFETCH(table[buckets[k]]);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i >= g.sizes.x) continue;
        ATOMIC_ADD_U64(table[buckets[k]], uint64(1u));
        uint64 entry = (uint64(priorities[k]) << 32) | uint64(i);
        for (uint slot = 1u; slot <= slots; ++slot) {
            uint64 old = ATOMIC_MAX_U64(table[buckets[k] + slot], entry);
            entry = min(old, entry);
            if (entry == uint64(0u)) break;
        }
    }
}

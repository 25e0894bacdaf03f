// Each photon overwrites the bucket that it falls into, and counts (Hachisuka and Jensen 2010). Who survives is a race: photons
// must come in an order that has nothing to do with what they carry.
#include "accel/stochastic_hash/stochastic_hash.layout.h"

BUFFER_RO(0, StochasticHash, hash)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uint, table)  // four words a bucket: count, -, photon, -

KERNEL(stochastic_hash_race) {
    PhotonGrid g = hash[0].grid;
    uint buckets[BATCH];
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i >= g.sizes.x) continue;
        buckets[k] = 4u * grid_entry(g, grid_cell(g, place_position(photons[i].place)));
        PREFETCH(table[buckets[k]]);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i >= g.sizes.x) continue;
        ATOMIC_STORE_U32(table[buckets[k] + 2u], i);
        ATOMIC_ADD_U32(table[buckets[k]], 1u);
    }
}

// Each photon overwrites the bucket that it falls into, and counts (Hachisuka and Jensen 2010). Who survives is a race, which the last
// to come wins: photons come in an order that has nothing to do with what they carry, since they were stored as their paths ended.
#include "accel/stochastic_hash/stochastic_hash.layout.h"

BUFFER_RO(0, StochasticHash, hash)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uint, table)  // four words a bucket: count, -, photon, -

KERNEL(stochastic_hash_race) {
    PhotonGrid g = hash[0].grid;
    uvec4 options = hash[0].options;
    uint buckets[BATCH];
    uint order[BATCH];
    uint from = batch_item(index, 0u);
    uint block = race_block(from, options.y, g.sizes.w);
    uint toss = hash32(block ^ g.sizes.w);
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (((i ^ from) >> RACE_BLOCK_BITS) != 0u) {
            from = i;
            block = race_block(i, options.y, g.sizes.w);
            toss = hash32(block ^ g.sizes.w);
        }
        order[k] = race_photon(i, block, toss);
        if (order[k] >= g.sizes.x) continue;
        buckets[k] = 4u * grid_entry(g, grid_cell(g, place_position(photons[order[k]].place)));
        PREFETCH(table[buckets[k]]);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        if (order[k] >= g.sizes.x) continue;
        ATOMIC_STORE_U32(table[buckets[k] + 2u], order[k]);
        ATOMIC_ADD_U32(table[buckets[k]], 1u);
    }
}

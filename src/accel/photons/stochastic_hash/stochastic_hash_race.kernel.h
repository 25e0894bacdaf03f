// Each photon overwrites the bucket that it falls into, and is counted (Hachisuka and Jensen 2010). The one written
// last survives. Photons are stored in the order in which their paths ended, which depends on what they carry; so they
// are inserted in a shuffled order.
#include "core/kernel/span.h"
#include "accel/photons/stochastic_hash/stochastic_hash_layout.h"

BUFFER_RO(0, StochasticHash, hash)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uint, table)  // four words a bucket: count, -, photon, -

KERNEL(stochastic_hash_race) {
    PhotonGrid g = hash[0].grid;
    uint race_bits = hash[0].race_bits;
    uint buckets[2u * BATCH];
    uint order[2u * BATCH];
    uint from = span_item(index, 0u, 0u);
    uint block = race_block(from, race_bits, g.option);
    uint toss = hash32(block ^ g.option);
    for (uint turn = 0u; turn <= SPAN; ++turn) {
        for (uint k = 0u; k < BATCH && turn < SPAN; ++k) {
            uint i = span_item(index, turn, k);
            if (((i ^ from) >> RACE_BLOCK_BITS) != 0u) {
                from = i;
                block = race_block(i, race_bits, g.option);
                toss = hash32(block ^ g.option);
            }
            uint room = span_room(turn, k);
            order[room] = race_photon(i, block, toss);
            if (order[room] >= g.count) continue;
            buckets[room] = 4u * grid_entry(g, grid_cell(g, place_position(photons[order[room]].place)));
            PREFETCH(table[buckets[room]]);
        }
        for (uint k = 0u; k < BATCH && turn > 0u; ++k) {
            uint room = span_room(turn - 1u, k);
            if (order[room] >= g.count) continue;
            ATOMIC_STORE_U32(table[buckets[room] + 2u], order[room]);
            ATOMIC_ADD_U32(table[buckets[room]], 1u);
        }
    }
}

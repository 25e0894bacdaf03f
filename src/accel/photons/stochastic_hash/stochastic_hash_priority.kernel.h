// Each photon's priority is a hash of its key: those of the highest priority in a bucket stay, in whatever order they
// arrive. One atomic maximum decides; with several slots, the entry that it displaces moves on to the next slot.
#include "core/kernel/span.h"
#include "accel/photons/stochastic_hash/stochastic_hash_layout.h"

BUFFER_RO(0, StochasticHash, hash)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uint64, table)

KERNEL(stochastic_hash_priority) {
    PhotonGrid g = hash[0].grid;
    uint slots = g.capacity;
    uint buckets[2u * BATCH];
    uint priorities[2u * BATCH];
    for (uint turn = 0u; turn <= SPAN; ++turn) {
        for (uint k = 0u; k < BATCH && turn < SPAN; ++k) {
            uint i = span_item(index, turn, k);
            if (i >= g.count) continue;
            uvec4 place = photons[i].place;
            uint room = span_room(turn, k);
            buckets[room] = (slots + 1u) * grid_entry(g, grid_cell(g, place_position(place)));
            priorities[room] = photon_priority(place.w, g.option);
            PREFETCH(table[buckets[room]]);
        }
        for (uint k = 0u; k < BATCH && turn > 0u; ++k) {
            uint i = span_item(index, turn - 1u, k);
            if (i >= g.count) continue;
            uint bucket = buckets[span_room(turn - 1u, k)];
            ATOMIC_ADD_U64(table[bucket], uint64(1u));
            uint64 entry = (uint64(priorities[span_room(turn - 1u, k)]) << 32) | uint64(i);
            for (uint slot = 1u; slot <= slots; ++slot) {
                uint64 old = ATOMIC_MAX_U64(table[bucket + slot], entry);
                entry = min(old, entry);
                if (entry == uint64(0u)) break;
            }
        }
    }
}

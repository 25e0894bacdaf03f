// Buckets of the stochastic hash. A bucket is a word of 64 bits that counts, and one for each slot: a photon's index, and above it what
// it won its place with.
#ifndef LAMPYRIS_STOCHASTIC_HASH
#define LAMPYRIS_STOCHASTIC_HASH

#include "core/kernel/photon_grid.h"

CONST uint SELECT_RACE = 0u;
CONST uint SELECT_PRIORITY = 1u;
CONST uint SELECT_FLUX = 2u;

// In PhotonGrid: entries are buckets, capacity the slots of each, option the seed of the selection.
struct StochasticHash {
    PhotonGrid grid;
    uint selection;    // SELECT_*
    uint race_bits;    // of the numbers that a race shuffles
    float flux_scale;  // weights of flux selection per power, 0: all alike
    uint unused0;
};

// A bijection for each seed: no two keys tie, and whom it picks does not depend on who came when.
FN uint photon_priority(uint key, uint seed) { return hash32(key ^ seed); }

// A permutation of the numbers of `bits` bits (1 to 32), for each seed: each step can be undone.
FN uint permuted(uint x, uint bits, uint seed) {
    uint mask = 0xffffffffu >> (32u - bits);
    uint half_way = (bits + 1u) / 2u;
    x = (x ^ seed) & mask;
    x = (x * 0x9e3779b1u) & mask;
    x = x ^ (x >> half_way);
    x = (x * (hash32(seed) | 1u)) & mask;
    x = x ^ (x >> half_way);
    x = (x * 0x85ebca6bu) & mask;
    return x ^ (x >> half_way);
}

// Where a race takes its photons from: blocks of 1024 come shuffled. Each is read from some place on, forwards or backwards: of two of
// its photons either is as likely to come first, and reads, most of what a race costs, stay in a row.
CONST uint RACE_BLOCK_BITS = 10u;
FN uint race_block(uint x, uint bits, uint seed) {
    return permuted(x >> RACE_BLOCK_BITS, bits - RACE_BLOCK_BITS, seed);
}
FN uint race_photon(uint x, uint block, uint toss) {
    uint mask = (1u << RACE_BLOCK_BITS) - 1u;
    return (block << RACE_BLOCK_BITS) | (((toss >> 31u) == 0u ? toss + x : toss - x) & mask);
}

// The weight by which flux selection prefers a photon: a whole number, so that sums of them have no order.
FN uint flux_weight(IN(PhotonRecord) photon, float scale) {
    Spectrum power = photon_power(photon);
    float w = (power[0] + power[1] + power[2]) * scale;
    return scale > 0.0f && w > 1.0f ? uint(min(w, 4194304.0f)) : (scale > 0.0f ? 1u : 1024u);
}

#endif

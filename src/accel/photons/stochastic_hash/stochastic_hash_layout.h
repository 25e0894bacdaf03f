// Buckets of the stochastic hash. A bucket is a 64-bit counter, and a 64-bit word for each slot: in the lower half a
// photon's index, in the upper half the rank by which it was selected (unless by a race).
#ifndef LAMPYRIS_STOCHASTIC_HASH
#define LAMPYRIS_STOCHASTIC_HASH

#include "core/kernel/photon_grid.h"

CONST uint SELECT_RACE = 0u;
CONST uint SELECT_PRIORITY = 1u;
CONST uint SELECT_FLUX = 2u;

// In PhotonGrid, `entries` is the number of buckets, `capacity` the slots of each, `option` the seed of the selection.
struct StochasticHash {
    PhotonGrid grid;
    uint selection;    // SELECT_*
    uint race_bits;    // number of bits of the indices that a race shuffles
    float flux_scale;  // weight per power for selection by flux; 0: all weights are equal
    uint unused0;
};

// A bijection for each seed, so that no two keys tie. The selection does not depend on the order of arrival.
FN uint photon_priority(uint key, uint seed) { return hash32(key ^ seed); }

// A permutation of the numbers of `bits` bits (1 to 32), for each seed: each step is invertible.
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

// The order in which a race inserts photons: blocks of 1024 are shuffled. Each block is read from a random index on,
// forwards or backwards, so that of any two of its photons either is equally likely to come first. Reads, the main cost
// of a race, stay contiguous.
CONST uint RACE_BLOCK_BITS = 10u;
FN uint race_block(uint x, uint bits, uint seed) {
    return permuted(x >> RACE_BLOCK_BITS, bits - RACE_BLOCK_BITS, seed);
}
FN uint race_photon(uint x, uint block, uint toss) {
    uint mask = (1u << RACE_BLOCK_BITS) - 1u;
    return (block << RACE_BLOCK_BITS) | (((toss >> 31u) == 0u ? toss + x : toss - x) & mask);
}

// A photon's weight for selection by flux: an integer, so that sums do not depend on their order.
FN uint flux_weight(IN(PhotonRecord) photon, float scale) {
    Spectrum power = photon_power(photon);
    float w = (power[0] + power[1] + power[2]) * scale;
    return scale > 0.0f && w > 1.0f ? uint(min(w, 4194304.0f)) : (scale > 0.0f ? 1u : 1024u);
}

#endif

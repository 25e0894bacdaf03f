// Buckets of the stochastic hash. A bucket is a word of 64 bits that counts, and one for each slot: a photon's index, and above it what
// it won its place with.
#ifndef LAMPYRIS_STOCHASTIC_HASH
#define LAMPYRIS_STOCHASTIC_HASH

#include "core/kernel/photon_grid.h"

CONST uint SELECT_RACE = 0u;
CONST uint SELECT_PRIORITY = 1u;
CONST uint SELECT_FLUX = 2u;

// In PhotonGrid: sizes.y buckets, sizes.z slots, sizes.w seed of the selection.
struct StochasticHash {
    PhotonGrid grid;
    uvec4 options;    // x: selection
    vec4 flux_scale;  // x: weights of flux selection per power, 0: all alike
};

// A bijection for each seed: no two keys tie, and whom it picks does not depend on who came when.
FN uint photon_priority(uint key, uint seed) { return hash32(key ^ seed); }

// The weight by which flux selection prefers a photon: a whole number, so that sums of them have no order.
FN uint flux_weight(IN(PhotonRecord) photon, float scale) {
    vec3 power = photon_power(photon);
    float w = (power.x + power.y + power.z) * scale;
    return scale > 0.0f && w > 1.0f ? uint(min(w, 4194304.0f)) : (scale > 0.0f ? 1u : 1024u);
}

#endif

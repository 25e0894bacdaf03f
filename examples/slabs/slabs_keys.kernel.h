// For each photon a pair to sort: its slab, and its index.
#include "slabs/slabs_function.h"

BUFFER_RO(0, Slabs, slabs)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uvec2, pairs)

KERNEL(slabs_keys) { pairs[index] = uvec2(slab_of(slabs[0], place_position(photons[index].place).z), index); }

// Computes the upper half of each photon's Morton code, by which photons are sorted.
#include "accel/photons/bvh/bvh_layout.h"

BUFFER_RO(0, TreeRecord, tree)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uvec2, pairs)

KERNEL(bvh_code) {
    if (index < tree[0].count)
        pairs[index] = uvec2(morton_code(tree[0], place_position(photons[index].place), 10u), index);
}

// Computes the key of each photon's cell, by which photons are sorted.
#include "accel/photons/cuckoo/cuckoo_layout.h"

BUFFER_RO(0, CuckooRecord, cuckoo)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RW(2, uvec2, pairs)

KERNEL(cuckoo_code) {
    PhotonGrid g = cuckoo[0].grid;
    if (index < g.count) pairs[index] = uvec2(cuckoo_key(g, grid_cell(g, place_position(photons[index].place))), index);
}

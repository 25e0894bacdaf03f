// Copies the photons in order, positions and the rest apart, and lists the runs: key, first photon.
#include "accel/cuckoo/cuckoo.layout.h"

BUFFER_RO(0, CuckooRecord, cuckoo)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RO(2, uvec2, pairs)
BUFFER_RO(3, uvec2, order)
BUFFER_RO(4, uint, runs)  // how many began before
BUFFER_RW(5, uvec4, places)
BUFFER_RW(6, uvec4, fluxes)
BUFFER_RW(7, uvec2, cells)

KERNEL(cuckoo_copy) {
    uint count = cuckoo[0].grid.sizes.x;
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i < count) PREFETCH(photons[order[i].y]);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i > count) continue;
        if (i == count) {
            cells[runs[i]] = uvec2(0u, count);  // where the last run ends
            continue;
        }
        uint photon = order[i].y;
        places[i] = photons[photon].place;
        fluxes[i] = photons[photon].flux;
        if (runs[i + 1u] != runs[i]) cells[runs[i]] = uvec2(pairs[i].x, i);
    }
}

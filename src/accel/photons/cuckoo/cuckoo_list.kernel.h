// Lists the runs: key, first photon.
#include "accel/photons/cuckoo/cuckoo_layout.h"

BUFFER_RO(0, CuckooRecord, cuckoo)
BUFFER_RO(1, uvec2, pairs)
BUFFER_RO(2, uint, runs)  // number of runs that begin before
BUFFER_RW(3, uvec2, cells)

KERNEL(cuckoo_list) {
    uint count = cuckoo[0].grid.count;
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i > count) continue;
        if (i == count) {
            cells[runs[i]] = uvec2(0u, count);  // the end of the last run
        } else if (runs[i + 1u] != runs[i]) {
            cells[runs[i]] = uvec2(pairs[i].x, i);
        }
    }
}

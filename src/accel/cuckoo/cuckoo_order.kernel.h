// The first photon of each run marks it, and sorts the run by key: the order must not depend on that of storage.
#include "accel/cuckoo/cuckoo.layout.h"

BUFFER_RO(0, CuckooRecord, cuckoo)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RO(2, uvec2, pairs)
BUFFER_RW(3, uvec2, order)
BUFFER_RW(4, uint, runs)  // 1 where one begins
#include "core/kernel/sort.h"

KERNEL(cuckoo_order) {
    uint count = cuckoo[0].grid.sizes.x;
    if (index >= count) return;
    uint code = pairs[index].x;
    bool first = index == 0u || pairs[index - 1u].x != code;
    runs[index] = first ? 1u : 0u;
    if (!first) return;
    uint end = index + 1u;
    for (; end < count && pairs[end].x == code; ++end) PREFETCH(photons[pairs[end].y].place);
    if (end != count && pairs[end].x == code) REPORT_UNFINISHED();
    if (end == index + 1u) {
        order[index] = pairs[index];
        return;
    }
    uint i = index;
    for (; i < end; ++i) order[i] = uvec2(photons[pairs[i].y].place.w, pairs[i].y);
    if (i != end) REPORT_UNFINISHED();
    sort_order(index, end);
}

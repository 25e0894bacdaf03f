// Photons that share the upper half of their code are sorted by the lower half, and where that is the same, too, by key: the order must
// not depend on that of storage. The first of each run does it.
#include "accel/bvh/bvh.layout.h"

BUFFER_RO(0, TreeRecord, tree)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RO(2, uvec2, pairs)
BUFFER_RW(3, uvec2, order)
#include "core/kernel/sort.h"

KERNEL(bvh_order) {
    uint count = tree[0].sizes.x;
    if (index >= count) return;
    uint code = pairs[index].x;
    if (index > 0u && pairs[index - 1u].x == code) return;
    uint end = index;
    for (; end < count && pairs[end].x == code; ++end) order[end] = pairs[end];
    if (end == index + 1u) return;
    if (end != count && pairs[end].x == code) REPORT_UNFINISHED();
    for (uint i = index; i < end; ++i) PREFETCH(photons[order[i].y].place);
    uint i = index;
    for (; i < end; ++i) order[i].x = morton_code(tree[0], place_position(photons[order[i].y].place), 0u);
    if (i != end) REPORT_UNFINISHED();
    sort_order(index, end);
    // Runs within the run.
    uint first = index;
    uint next = index + 1u;
    for (; next <= end; ++next) {
        if (next < end && order[next].x == order[first].x) continue;
        if (next - first > 1u) {
            for (uint k = first; k < next; ++k) order[k].x = photons[order[k].y].place.w;
            sort_order(first, next);
        }
        first = next;
    }
    if (next != end + 1u) REPORT_UNFINISHED();
}

// Visits the slabs that a query's sphere overlaps.
#include "core/kernel/gather.h"
#include "slabs/slabs_function.h"

BUFFER_RO(1, Slabs, slabs)
BUFFER_RO(2, PhotonRecord, ordered)
BUFFER_RO(3, uint, starts)

KERNEL(slabs) {
    vec4 q = queries[index];
    if (q.w < 0.0f) return;
    Gathered gathered = gather_begin(index);
    Slabs s = slabs[0];
    float reach = range_reach(q.w);
    uint i = starts[slab_of(s, q.z - reach)];
    uint end = starts[slab_of(s, q.z + reach) + 1u];
    for (; i < end; ++i) {
        float d2;
        if (in_range(place_position(ordered[i].place), vec3(q), q.w, d2))
            gather_add(gathered, index, ordered[i], d2, 1.0f);
    }
    if (i != end) REPORT_UNFINISHED();
    gather_end(gathered, index);
}

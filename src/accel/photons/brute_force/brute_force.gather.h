// Tests every photon: the reference that every other structure is tested against.
#include "core/kernel/gather.h"

BUFFER_RO(1, uvec4, arguments)  // x: number of photons
BUFFER_RO(2, PhotonRecord, photons)

KERNEL(brute_force) {
    vec4 q = queries[index];
    if (q.w < 0.0f) return;
    Gathered g = gather_begin(index);
    uint count = arguments[0].x;
    uint i = 0u;
    for (; i < count; ++i) {
        float d2;
        if (in_range(place_position(photons[i].place), vec3(q), q.w, d2)) gather_add(g, index, photons[i], d2, 1.0f);
    }
    if (i != count) REPORT_UNFINISHED();
    gather_end(g, index);
}

// Copies the photons in order, positions and the rest apart, and bounds each leaf.
#include "accel/bvh/bvh.layout.h"

BUFFER_RO(0, TreeRecord, tree)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RO(2, uvec2, order)
BUFFER_RW(3, uvec4, places)
BUFFER_RW(4, uvec4, fluxes)
BUFFER_RW(5, TreeBox, boxes)

KERNEL(bvh_leaves) {
    uvec4 sizes = tree[0].sizes;
    if (index >= tree[0].levels[0].y) return;
    uint begin = index * sizes.y;
    uint end = min(begin + sizes.y, sizes.x);
    for (uint i = begin; i < end; ++i) PREFETCH(photons[order[i].y]);
    vec3 low = vec3(3e38f);
    vec3 high = vec3(-3e38f);
    for (uint i = begin; i < end; ++i) {
        PhotonRecord photon = photons[order[i].y];
        places[i] = photon.place;
        fluxes[i] = photon.flux;
        low = min(low, photon_position(photon));
        high = max(high, photon_position(photon));
    }
    boxes[index].low = vec4(low.x, low.y, low.z, 0.0f);
    boxes[index].high = vec4(high.x, high.y, high.z, 0.0f);
}

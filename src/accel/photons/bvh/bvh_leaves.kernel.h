// Computes the box of each leaf, which is a run of photons.
#include "accel/photons/bvh/bvh_layout.h"

BUFFER_RO(0, TreeRecord, tree)
BUFFER_RO(1, uvec4, places)
BUFFER_RW(2, TreeBox, boxes)

KERNEL(bvh_leaves) {
    uint begin = index * tree[0].leaf_photons;
    uint end = min(begin + tree[0].leaf_photons, tree[0].count);
    vec3 low = vec3(3e38f);
    vec3 high = vec3(-3e38f);
    for (uint i = begin; i < end; ++i) {
        vec3 p = place_position(places[i]);
        low = min(low, p);
        high = max(high, p);
    }
    boxes[index].low = vec4(low.x, low.y, low.z, 0.0f);
    boxes[index].high = vec4(high.x, high.y, high.z, 0.0f);
}

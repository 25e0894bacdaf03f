// Computes one level of boxes from the level below.
#include "accel/photons/bvh/bvh_layout.h"

BUFFER_RO(0, TreeRecord, tree)
BUFFER_RW(1, TreeBox, boxes)

KERNEL(bvh_level) {
    uint level = tree[0].built_level;
    uvec4 below = tree[0].levels[level - 1u];
    vec3 low = vec3(3e38f);
    vec3 high = vec3(-3e38f);
    for (uint k = 4u * index; k < min(4u * index + 4u, below.y); ++k) {
        low = min(low, vec3(boxes[below.x + k].low));
        high = max(high, vec3(boxes[below.x + k].high));
    }
    uint place = tree[0].levels[level].x + index;
    boxes[place].low = vec4(low.x, low.y, low.z, 0.0f);
    boxes[place].high = vec4(high.x, high.y, high.z, 0.0f);
}

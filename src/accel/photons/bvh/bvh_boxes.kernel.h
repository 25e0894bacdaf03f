// For ray queries: the box around each photon that contains every query point that finds the photon.
#include "accel/photons/bvh/bvh_layout.h"

BUFFER_RO(0, TreeRecord, tree)
BUFFER_RO(1, uvec4, places)
BUFFER_RW(2, float, boxes)

// range_reach alone would suffice: rounding is monotonic, so a float q >= p - reach is not below the float nearest to p
// - reach. The margin is four times the rounding error of the largest number involved. It keeps q off the faces, for
// drivers that scale origin and box by the inverse direction before they subtract, and gives every box a volume.
CONST float BOX_MARGIN = 2.3841858e-7f;  // 2^-22

KERNEL(bvh_boxes) {
    if (index >= tree[0].count) return;
    vec3 p = place_position(places[index]);
    vec3 reach = vec3(range_reach(tree[0].radius.x));
    vec3 side = reach + (abs(p) + reach) * BOX_MARGIN;
    vec3 low = p - side;
    vec3 high = p + side;
    boxes[6u * index] = low.x;
    boxes[6u * index + 1u] = low.y;
    boxes[6u * index + 2u] = low.z;
    boxes[6u * index + 3u] = high.x;
    boxes[6u * index + 4u] = high.y;
    boxes[6u * index + 5u] = high.z;
}

// Walks the tree depth first, without a stack: from node i of a level to its first child 4i, or where its box is out of range or its
// photons are done, to the next sibling, or up.
#include "core/kernel/gather.h"
#include "accel/bvh/bvh.layout.h"

BUFFER_RO(1, TreeRecord, tree)
BUFFER_RO(2, TreeBox, boxes)
BUFFER_RO(3, uvec4, places)
BUFFER_RO(4, uvec4, fluxes)

// No photon in a box that fails this is in range: each step of in_range keeps order, whatever it rounds.
FN bool box_in_range(IN(TreeBox) box, vec3 q, float radius) {
    vec3 d = max(max(vec3(box.low) - q, q - vec3(box.high)), vec3(0.0f));
    return d.x * d.x + d.y * d.y + d.z * d.z <= max(radius * radius, SMALLEST_RADIUS_SQUARED);
}

KERNEL(bvh) {
    vec4 q = queries[index];
    if (q.w < 0.0f) return;
    Gathered gathered = gather_begin(index);
    uvec4 sizes = tree[0].sizes;
    uint root = sizes.z - 1u;
    uint level = root;
    uint node = 0u;
    bool finished = sizes.x == 0u;
    // Every node once, at most.
    for (uint steps = 0u; !finished && steps <= 2u * sizes.x + 64u; ++steps) {
        uvec4 of_level = tree[0].levels[level];
        if (node < of_level.y && box_in_range(boxes[of_level.x + node], vec3(q), q.w)) {
            if (level > 0u) {
                level -= 1u;
                node = 4u * node;
                continue;
            }
            uint end = min((node + 1u) * sizes.y, sizes.x);
            uint i = node * sizes.y;
            for (; i < end; ++i) {
                uvec4 place = places[i];
                float d2;
                if (!in_range(place_position(place), vec3(q), q.w, d2)) continue;
                PhotonRecord photon;
                photon.place = place;
                photon.flux = fluxes[i];
                gather_add(gathered, index, photon, d2, 1.0f);
            }
            if (i != end) REPORT_UNFINISHED();
        }
        while (level < root && (node & 3u) == 3u) {
            node = node >> 2u;
            level += 1u;
        }
        if (level >= root) finished = true;
        node += 1u;
    }
    if (!finished) REPORT_UNFINISHED();
    gather_end(gathered, index);
}

// Traverses the tree depth first, without a stack: from node i of a level to its first child 4i; or, if its box is out
// of range or its photons are done, to the next sibling, or up. Children are visited in the order of node ^ first,
// where `first` is the path to a leaf. For consumers that shrink their limit this leaf is near the query, so that its
// neighbours are visited before the rest.
#include "core/kernel/gather.h"
#include "accel/photons/bvh/bvh_layout.h"

BUFFER_RO(1, TreeRecord, tree)
BUFFER_RO(2, TreeBox, boxes)
BUFFER_RO(3, uvec4, places)
BUFFER_RO(4, uvec4, fluxes)

// No photon of the box is nearer: the operations are those of in_range, each of which is monotonic, even when rounded.
FN float box_distance_squared(IN(TreeBox) box, vec3 q) {
    vec3 d = max(max(vec3(box.low) - q, q - vec3(box.high)), vec3(0.0f));
    return d.x * d.x + d.y * d.y + d.z * d.z;
}

// A leaf near q, found by descending from the root to the nearest child.
FN uint leaf_near(vec3 q, uint root) {
    uint node = 0u;
    uint level = root;
    for (; level > 0u; --level) {
        uvec4 below = tree[0].levels[level - 1u];
        uint child = 4u * node;
        uint end = min(child + 4u, below.y);
        node = child;
        float least = 3.4e38f;
        for (; child < end; ++child) {
            float d2 = box_distance_squared(boxes[below.x + child], q);
            if (d2 < least) {
                least = d2;
                node = child;
            }
        }
    }
    return node;
}

KERNEL(bvh) {
    vec4 q = queries[index];
    if (q.w < 0.0f) return;
    Gathered gathered = gather_begin(index);
    uint count = tree[0].count;
    uint leaf_photons = tree[0].leaf_photons;
    uint root = tree[0].level_count - 1u;
    uint level = root;
    uint visit = 0u;  // node ^ (first >> 2 level)
    float limit = max(q.w * q.w, SMALLEST_RADIUS_SQUARED);
    uint first = 0u;
#ifdef GATHER_SHRINKS
    if (count > 0u) first = leaf_near(vec3(q), root);
#endif
    bool finished = count == 0u;
    // Each node is visited at most once, so this bound is never reached.
    for (uint steps = 0u; !finished && steps <= 2u * count + 64u; ++steps) {
        uvec4 of_level = tree[0].levels[level];
        uint node = visit ^ (first >> (2u * level));
        if (node < of_level.y && box_distance_squared(boxes[of_level.x + node], vec3(q)) <= limit) {
            if (level > 0u) {
                level -= 1u;
                visit = 4u * visit;
                continue;
            }
            uint end = min((node + 1u) * leaf_photons, count);
            uint i = node * leaf_photons;
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
#ifdef GATHER_SHRINKS
            limit = gather_limit(gathered);
#endif
        }
        while (level < root && (visit & 3u) == 3u) {
            visit = visit >> 2u;
            level += 1u;
        }
        if (level >= root) finished = true;
        visit += 1u;
    }
    if (!finished) REPORT_UNFINISHED();
    gather_end(gathered, index);
}

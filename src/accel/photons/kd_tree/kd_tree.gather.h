// Traverses the tree, nearer side first. Sides that are still to be visited wait on a stack, with the distance to their
// regions.
#include "core/kernel/gather.h"
#include "accel/photons/kd_tree/kd_tree_layout.h"

BUFFER_RO(1, KdArgs, arguments)
BUFFER_RO(2, KdNode, nodes)
BUFFER_RO(3, uvec4, places)
BUFFER_RO(4, uvec4, fluxes)

// Only sides that are in range wait, and rarely more than a few. If the stack is full, a node is read like a leaf.
CONST uint KD_STACK = 32u;

FN vec3 kd_replaced(vec3 v, uint axis, float x) {
    return vec3(axis == 0u ? x : v.x, axis == 1u ? x : v.y, axis == 2u ? x : v.z);
}
// The operations of in_range, in the same order.
FN float kd_squared(vec3 d) { return d.x * d.x + d.y * d.y + d.z * d.z; }

KERNEL(kd_tree) {
    vec4 q = queries[index];
    if (q.w < 0.0f) return;
    Gathered gathered = gather_begin(index);
    uint count = arguments[0].count;
    float limit = max(q.w * q.w, SMALLEST_RADIUS_SQUARED);
#ifdef GATHER_SHRINKS
    limit = min(limit, gather_limit(gathered));
#endif
    // x: 1 for a node, 0 for a leaf; y: the node; z, w: its first photon, and the one after its last.
    uvec4 stack[KD_STACK];
    vec4 stack_apart[KD_STACK];  // w: squared distance
    uint waiting = 0u;
    uint node = 0u;
    bool is_node = count > 0u && nodes[1].words.x != 0u;
    uint begin = 0u;
    uint end = count;
    // The distance of the query from the node's region, along each axis. No photon there can be nearer: the difference
    // to a bound, and all operations of in_range on it, are monotonic, even when rounded.
    vec3 apart = vec3(0.0f);
    bool finished = count == 0u;
    // Each node and leaf is visited once at most, and waits once at most, so this bound is never reached.
    for (uint steps = 0u; !finished && steps <= 4u * count + 64u; ++steps) {
        bool descends = false;
        if (is_node && waiting < KD_STACK) {
            KdNode n = nodes[node];
            uint child = kd_child(n);
            uint middle = n.words.z;
            // Prefetches a grandchild. In the first round's levels, its index is the one that it would have in a heap.
            if (2u * child < arguments[0].next_node) PREFETCH(nodes[2u * child]);
            if (end - begin < 64u) {
                PREFETCH(places[begin]);
                PREFETCH(places[middle]);
            }
            uint axis = kd_axis(n);
            float x = kd_coordinate(vec3(q), axis);
            float at = kd_coordinate(apart, axis);
            float left = max(at, x - uintBitsToFloat(n.words.x));
            float right = max(at, uintBitsToFloat(n.words.y) - x);
            bool left_is_near = left <= right;
            vec3 near_side = kd_replaced(apart, axis, left_is_near ? left : right);
            vec3 far_side = kd_replaced(apart, axis, left_is_near ? right : left);
            float far_squared = kd_squared(far_side);
            bool far_is_node = left_is_near ? kd_right_is_node(n) : kd_left_is_node(n);
            uint far_child = left_is_near ? child + 1u : child;
            uint far_begin = left_is_near ? middle : begin;
            uint far_end = left_is_near ? end : middle;
            if (far_squared <= limit) {
                stack[waiting] = uvec4(far_is_node ? 1u : 0u, far_child, far_begin, far_end);
                stack_apart[waiting] = vec4(far_side.x, far_side.y, far_side.z, far_squared);
                waiting += 1u;
                if (far_is_node)
                    PREFETCH(nodes[far_child]);
                else
                    PREFETCH(places[far_begin]);
            }
            descends = kd_squared(near_side) <= limit;
            is_node = left_is_near ? kd_left_is_node(n) : kd_right_is_node(n);
            node = left_is_near ? child : child + 1u;
            begin = left_is_near ? begin : middle;
            end = left_is_near ? middle : end;
            apart = near_side;
        } else {
            for (uint i = begin; i < end; ++i) {
                float d2;
                bool wanted = in_range(place_position(places[i]), vec3(q), q.w, d2);
#ifdef GATHER_SHRINKS
                wanted = wanted && d2 <= limit;
#endif
                if (wanted) PREFETCH(fluxes[i]);
            }
            uint i = begin;
            for (; i < end; ++i) {
                uvec4 place = places[i];
                float d2;
                if (!in_range(place_position(place), vec3(q), q.w, d2)) continue;
#ifdef GATHER_SHRINKS
                if (d2 > limit) continue;
#endif
                PhotonRecord photon;
                photon.place = place;
                photon.flux = fluxes[i];
                gather_add(gathered, index, photon, d2, 1.0f);
#ifdef GATHER_SHRINKS
                limit = min(limit, gather_limit(gathered));
#endif
            }
            if (i != end) REPORT_UNFINISHED();
        }
        if (descends) continue;
        // Takes the side that was added last and is still in range.
        bool found = false;
        while (waiting > 0u && !found) {
            waiting -= 1u;
            found = stack_apart[waiting].w <= limit;
        }
        finished = !found;
        is_node = stack[waiting].x != 0u;
        node = stack[waiting].y;
        begin = stack[waiting].z;
        end = stack[waiting].w;
        apart = vec3(stack_apart[waiting]);
    }
    if (!finished) REPORT_UNFINISHED();
    gather_end(gathered, index);
}

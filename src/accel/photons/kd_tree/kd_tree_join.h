// Builds the four levels (or fewer) of nodes above a group of cells, or of nodes, bottom up. Before including this
// file, a kernel must declare BUFFER_RW(..., KdNode, nodes).
//
// A large node is stored at its base, the nodes below it at base + their number in a heap (1 is the root, 2h and 2h + 1
// are the children of h); base + 1 is left free for a sibling. If all photons of a node lie in one of its halves, the
// node is omitted and that half takes its place, so that empty space is cut off without a node.
#ifndef LAMPYRIS_KD_TREE_JOIN
#define LAMPYRIS_KD_TREE_JOIN

#include "accel/photons/kd_tree/kd_tree_layout.h"

struct KdGroup {
    vec4 low[KD_GROUP];
    vec4 high[KD_GROUP];
    uint starts[KD_GROUP + 1u];  // index of each one's first photon
    uint places[KD_GROUP];       // indices of their nodes
    uint are_nodes;              // a bit for each: 1 for a node, 0 for a leaf or if empty
};

FN uint kd_heap_place(uint base, uint number) { return number == 1u ? base : base + number; }

// Joins `width` nodes of level `of_level` below the large node (level 0 is the large node itself), the first of which
// is number `first` of its level. Returns the box of the root of what was built.
FN KdBox kd_join(IN(KdLarge) large, uint base, uint leaf, uint of_level, uint first, uint width, INOUT(KdGroup) g) {
    uint stride = 1u;
    uint level = of_level;
    uint first_child = first;
    for (uint children = width; children > 1u; children = children / 2u) {
        uint axis = kd_level_axis(large, level - 1u);
        bool are_cells = level == large.cells.y;
        uint are_nodes = 0u;
        for (uint i = 0u; i < children / 2u; ++i) {
            uint begin = g.starts[2u * i * stride];
            uint middle = g.starts[(2u * i + 1u) * stride];
            uint end = g.starts[(2u * i + 2u) * stride];
            uint left = 2u * i;
            uint right = 2u * i + 1u;
            bool left_is_node = ((g.are_nodes >> left) & 1u) != 0u;
            bool right_is_node = ((g.are_nodes >> right) & 1u) != 0u;
            uint number = (1u << level) + first_child + 2u * i;
            uint place = g.places[left];
            bool is_node = left_is_node || right_is_node;
            if (middle == begin) {
                place = g.places[right];
            } else if (middle != end) {
                is_node = end - begin > leaf;
                uint child = base + number;
                if (are_cells) child = left_is_node ? g.places[left] : g.places[right] - 1u;
                if (is_node && left_is_node && g.places[left] != child) nodes[child] = nodes[g.places[left]];
                if (is_node && right_is_node && g.places[right] != child + 1u)
                    nodes[child + 1u] = nodes[g.places[right]];
                place = kd_heap_place(base, number / 2u);
                if (is_node)
                    nodes[place].words =
                        uvec4(floatBitsToUint(kd_coordinate(vec3(g.high[left]), axis)),
                              floatBitsToUint(kd_coordinate(vec3(g.low[right]), axis)), middle,
                              (child << 4u) | (right_is_node ? 8u : 0u) | (left_is_node ? 4u : 0u) | axis);
            }
            g.low[i] = min(g.low[left], g.low[right]);
            g.high[i] = max(g.high[left], g.high[right]);
            g.places[i] = place;
            are_nodes |= is_node ? 1u << i : 0u;
        }
        g.are_nodes = are_nodes;
        stride *= 2u;
        level -= 1u;
        first_child = first_child / 2u;
    }
    // The index at which the next step, or the parent, looks for the root.
    uint place = kd_heap_place(base, (1u << level) + first_child);
    if (g.are_nodes != 0u && g.places[0] != place) nodes[place] = nodes[g.places[0]];
    KdBox box;
    box.low = vec4(g.low[0].x, g.low[0].y, g.low[0].z, g.are_nodes != 0u ? 1.0f : 0.0f);
    box.high = g.high[0];
    return box;
}

// The root of the whole tree may be a leaf: the free place beside it says whether it is a node.
FN void kd_join_root(IN(KdLarge) large, uint round, uint built, IN(KdBox) box) {
    if (round == 0u && large.cells.y == built) nodes[1].words = uvec4(box.low.w != 0.0f ? 1u : 0u, 0u, 0u, 0u);
}

#endif

// A kd-tree over photons, built breadth first: a round splits each large node (one with more photons than two leaves,
// see kd_is_large) several levels down at once, at spatial middles. The cells below the last level are numbered so that
// every node above them is a range of cells, and photons are sorted by cell. Cells that are still large are the next
// round's nodes.
#ifndef LAMPYRIS_KD_TREE
#define LAMPYRIS_KD_TREE

#include "core/kernel/photon.h"

CONST uint KD_GROUP_LEVELS = 4u;    // levels that one invocation builds, bottom up
CONST uint KD_GROUP = 16u;          // cells, or nodes of one level, that it starts from
CONST uint KD_CHUNK = 32u * BATCH;  // photons of a large node that 32 invocations share
CONST uint KD_MAX_LEAF = 64u;
CONST uint KD_SPATIAL_ROUNDS = 6u;  // photons that these do not separate are split by key

// A node of the tree has photons on both sides. Its range of photons is not stored, because it is known on reaching the
// node. Bounds are tight.
struct KdNode {
    // x: highest coordinate of the left photons along the axis, y: lowest of the right ones (floats' bits); z: index of
    // the first right photon; w: index of the left child, which the right child follows (28 bits); whether the right
    // and the left child are nodes, not leaves (2 bits); the axis (2 bits).
    uvec4 words;
};
FN uint kd_axis(IN(KdNode) node) { return node.words.w & 3u; }
FN bool kd_left_is_node(IN(KdNode) node) { return (node.words.w & 4u) != 0u; }
FN bool kd_right_is_node(IN(KdNode) node) { return (node.words.w & 8u) != 0u; }
FN uint kd_child(IN(KdNode) node) { return node.words.w >> 4u; }

// The bounds of a node, while the tree is being built. low.w: 1 for a node, 0 for a leaf (or if empty).
struct KdBox {
    vec4 low;
    vec4 high;
};

struct KdArgs {
    uint count;         // of photons
    uint leaf_photons;  // of a leaf, at most, on average
    uint round;
    uint groups;      // of cells, in this round
    uint first_node;  // of this round
    uint next_node;   // first node of the next round
    uint step;        // of kd_tree_levels; in kd_tree_list: 0 counts, 1 writes
    uint unused0;
};

struct KdLarge {
    uvec4 photons;  // x: first, y: number; z: first chunk
    uvec4 cells;    // x: index of the first one in this round, y: levels, so that there are 2^y cells
    // Least and greatest coordinates and key, as integers of the same order (kd_ordered). The least ones are stored as
    // complements, because there is only an atomic maximum.
    uvec4 least;
    uvec4 greatest;
    vec4 scale;    // of each axis, cells per unit length
    vec4 limit;    // of each axis, the number of the last cell
    uvec4 shifts;  // of each axis: see kd_part()
    uvec4 shape;   // x: levels along the longest axis alone, y: pairs of levels, z: triples; w: surplus levels in these
    uvec4 axes;    // x, y, z: the axes, longest first; w: 32 + shift of the key if photons are split by key, else 0
};

FN uint kd_ordered(float x) {
    uint bits = floatBitsToUint(x);
    return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}
FN float kd_float(uint ordered) {
    return uintBitsToFloat((ordered & 0x80000000u) != 0u ? ordered & 0x7fffffffu : ~ordered);
}
FN vec3 kd_low(IN(KdLarge) n) { return vec3(kd_float(~n.least.x), kd_float(~n.least.y), kd_float(~n.least.z)); }
FN vec3 kd_high(IN(KdLarge) n) { return vec3(kd_float(n.greatest.x), kd_float(n.greatest.y), kd_float(n.greatest.z)); }
FN float kd_coordinate(vec3 p, uint axis) { return axis == 0u ? p.x : (axis == 1u ? p.y : p.z); }

// The number of levels that a round splits a node of `count` photons: as few as give cells no more photons than a leaf,
// on average, but at least KD_GROUP_LEVELS.
FN uint kd_levels(uint count, uint leaf) {
    uint levels = KD_GROUP_LEVELS;
    while (levels < 24u && (leaf << levels) < count) levels += 1u;
    return levels;
}
FN bool kd_is_large(uint count, uint leaf) { return count > 2u * leaf; }

// Chooses the axis that each level splits, from the node's extents: the one along which its cells are longest. That is
// the longest axis alone until it is less than twice the second, then both in turn, then all three.
FN void kd_shape(INOUT(KdLarge) n, uint round) {
    vec3 extent = kd_high(n) - kd_low(n);
    uint a = extent.x >= extent.y ? 0u : 1u;
    uint b = 1u - a;
    uint c = 2u;
    if (extent.z > kd_coordinate(extent, a)) {
        c = b;
        b = a;
        a = 2u;
    } else if (extent.z > kd_coordinate(extent, b)) {
        c = b;
        b = 2u;
    }
    uint levels = n.cells.y;
    float longest = kd_coordinate(extent, a);
    if (!(longest > 1e-30f && longest < 1e38f) || round >= KD_SPATIAL_ROUNDS) {
        uint shift = 0u;
        while (shift < 31u && ((n.greatest.w - ~n.least.w) >> shift) >> levels != 0u) shift += 1u;
        n.axes = uvec4(0u, 0u, 0u, 32u + shift);
        n.shape = uvec4(levels, 0u, 0u, 0u);
        return;
    }
    uint alone = 0u;
    uint pairs = 0u;
    uint triples = 0u;
    for (float side = 0.5f * longest; alone < levels && side >= kd_coordinate(extent, b); side *= 0.5f) alone += 1u;
    uint rest = levels - alone;
    for (float side = 0.5f * kd_coordinate(extent, b); 2u * pairs < rest && side >= kd_coordinate(extent, c);
         side *= 0.5f)
        pairs += 1u;
    if (2u * pairs < rest) triples = (rest - 2u * pairs + 2u) / 3u;
    n.axes = uvec4(a, b, c, 0u);
    n.shape = uvec4(alone, pairs, triples, alone + 2u * pairs + 3u * triples - levels);
    for (uint axis = 0u; axis < 3u; ++axis) {
        uint bits = axis == a ? alone + pairs + triples : (axis == b ? pairs + triples : triples);
        float cells = float(1u << bits);
        float scale = bits > 0u ? cells / kd_coordinate(extent, axis) : 0.0f;
        // Shifts in a cell's number: of the triples' bits, of the pairs', of the others.
        uint shift = axis == a ? 2u | ((3u * triples + 1u) << 8u) | ((3u * triples + 2u * pairs) << 16u)
                               : (axis == b ? 1u | ((3u * triples) << 8u) : 0u);
        n.scale.x = axis == 0u ? scale : n.scale.x;
        n.scale.y = axis == 1u ? scale : n.scale.y;
        n.scale.z = axis == 2u ? scale : n.scale.z;
        n.limit.x = axis == 0u ? cells - 1.0f : n.limit.x;
        n.limit.y = axis == 1u ? cells - 1.0f : n.limit.y;
        n.limit.z = axis == 2u ? cells - 1.0f : n.limit.z;
        n.shifts.x = axis == 0u ? shift : n.shifts.x;
        n.shifts.y = axis == 1u ? shift : n.shifts.y;
        n.shifts.z = axis == 2u ? shift : n.shifts.z;
    }
}

// The axis that splits the nodes of a level. Level 0 is the large node itself.
FN uint kd_level_axis(IN(KdLarge) n, uint level) {
    if (level < n.shape.x) return n.axes.x;
    uint of_pairs = level - n.shape.x;
    if (of_pairs < 2u * n.shape.y) return (of_pairs & 1u) == 0u ? n.axes.x : n.axes.y;
    uint of_triples = (of_pairs - 2u * n.shape.y) % 3u;
    return of_triples == 0u ? n.axes.x : (of_triples == 1u ? n.axes.y : n.axes.z);
}

// Spread up to 16 bits with one zero after each, and up to 10 bits with two.
FN uint kd_spread2(uint x) {
    uint v = (x | (x << 8u)) & 0x00ff00ffu;
    v = (v | (v << 4u)) & 0x0f0f0f0fu;
    v = (v | (v << 2u)) & 0x33333333u;
    return (v | (v << 1u)) & 0x55555555u;
}
FN uint kd_spread3(uint x) {
    uint v = (x | (x << 16u)) & 0x030000ffu;
    v = (v | (v << 8u)) & 0x0300f00fu;
    v = (v | (v << 4u)) & 0x030c30c3u;
    return (v | (v << 2u)) & 0x09249249u;
}
// The bits of a cell's number that come from the coordinate along one axis.
FN uint kd_part(float x, float origin, float scale, float limit, uint shifts, uint pairs, uint triples) {
    float t = min((x - origin) * scale, limit);
    uint cell = uint(int(t > 0.0f ? t : 0.0f));  // NaN maps to cell 0
    return (kd_spread3(cell & ((1u << triples) - 1u)) << (shifts & 31u)) |
           (kd_spread2((cell >> triples) & ((1u << pairs) - 1u)) << ((shifts >> 8u) & 31u)) |
           ((cell >> (triples + pairs)) << (shifts >> 16u));
}
// The cell of a photon among those of its node: kd_key_cell if photons are split by key, else kd_cell, in which each
// step is monotonic, even when rounded.
FN bool kd_by_key(IN(KdLarge) n) { return n.axes.w != 0u; }
FN uint kd_key_cell(IN(KdLarge) n, uint key) { return (key - ~n.least.w) >> (n.axes.w - 32u); }
FN uint kd_cell(IN(KdLarge) n, vec3 low, vec3 p) {
    return (kd_part(p.x, low.x, n.scale.x, n.limit.x, n.shifts.x, n.shape.y, n.shape.z) |
            kd_part(p.y, low.y, n.scale.y, n.limit.y, n.shifts.y, n.shape.y, n.shape.z) |
            kd_part(p.z, low.z, n.scale.z, n.limit.z, n.shifts.z, n.shape.y, n.shape.z)) >>
           n.shape.w;
}

#endif

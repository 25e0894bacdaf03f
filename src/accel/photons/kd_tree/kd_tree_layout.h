// A kd-tree over photons, built breadth first: a round takes each large node (one of more photons than a leaf may have) down
// several levels of splits in the spatial middle at once. The cells that these end in are numbered so that every node between is a
// range of cells, and photons are sorted by cell; cells that are large again are the next round's nodes.
#ifndef LAMPYRIS_KD_TREE
#define LAMPYRIS_KD_TREE

#include "core/kernel/photon.h"

CONST uint KD_GROUP_LEVELS = 4u;    // that one invocation builds, bottom up
CONST uint KD_GROUP = 16u;          // cells, or nodes of one level, below them
CONST uint KD_CHUNK = 32u * BATCH;  // photons of a large node that 32 invocations share
CONST uint KD_MAX_LEAF = 64u;
CONST uint KD_SPATIAL_ROUNDS = 6u;  // what these do not separate is split by key

// A node of the tree has photons on both sides. Its photons are a range that whoever comes to it knows; bounds are tight.
struct KdNode {
    // x: highest coordinate of the left photons along the axis, y: lowest of the right ones (floats' bits); z: the first photon that
    // is right; w: place of the left child, that of the right one is next (28 bits); 2 bits: whether left and right are
    // nodes, not leaves; 2 bits: the axis.
    uvec4 words;
};
FN uint kd_axis(IN(KdNode) node) { return node.words.w & 3u; }
FN bool kd_left_is_node(IN(KdNode) node) { return (node.words.w & 4u) != 0u; }
FN bool kd_right_is_node(IN(KdNode) node) { return (node.words.w & 8u) != 0u; }
FN uint kd_child(IN(KdNode) node) { return node.words.w >> 4u; }

// Of a node, while the tree is being built. low.w: 1 where it is a node, 0 where it is a leaf (or empty).
struct KdBox {
    vec4 low;
    vec4 high;
};

struct KdArgs {
    uint count;         // of photons
    uint leaf_photons;  // of a leaf, on average at most
    uint round;
    uint groups;      // of cells, in this round
    uint first_node;  // of the round
    uint next_node;   // the next round's first
    uint step;        // of levels; of list, whether it is its second run
    uint unused0;
};

struct KdLarge {
    uvec4 photons;  // x: first, y: number; z: first chunk
    uvec4 cells;    // x: first of the round's, y: levels, so that there are 2^y
    // Least and greatest coordinates and key, as numbers that order like them; of the least, the complement: there is an atomic
    // maximum only.
    uvec4 least;
    uvec4 greatest;
    vec4 scale;    // of each axis, cells per unit
    vec4 limit;    // the last cell
    uvec4 shifts;  // of each axis, kd_part()
    uvec4
        shape;   // x: levels along the longest axis alone, y: pairs of levels, z: triples; w: levels too many, in these
    uvec4 axes;  // x, y, z: the axes, longest first; w: 0, or 32 + shift of the key where photons are split by key
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

// Levels that a round takes a node of `count` photons down: on average, cells have more than half a leaf, and no more than a leaf.
FN uint kd_levels(uint count, uint leaf) {
    uint levels = KD_GROUP_LEVELS;
    while (levels < 24u && (leaf << levels) < count) levels += 1u;
    return levels;
}
FN bool kd_is_large(uint count, uint leaf) { return count > 2u * leaf; }

// Which axis each level splits: always the one along which cells are longest, as far as this can be said before. That is the longest
// axis alone until it is less than twice the second, then both in turn, then all three.
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
        // Where a triple's bits go, where a pair's, where the others.
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

// The axis that splits the nodes of a level, 0 at the large node itself.
FN uint kd_level_axis(IN(KdLarge) n, uint level) {
    if (level < n.shape.x) return n.axes.x;
    uint of_pairs = level - n.shape.x;
    if (of_pairs < 2u * n.shape.y) return (of_pairs & 1u) == 0u ? n.axes.x : n.axes.y;
    uint of_triples = (of_pairs - 2u * n.shape.y) % 3u;
    return of_triples == 0u ? n.axes.x : (of_triples == 1u ? n.axes.y : n.axes.z);
}

// Up to 16 bits, a zero after each; up to 10, two.
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
// What one axis' coordinate puts into the number of a cell.
FN uint kd_part(float x, float origin, float scale, float limit, uint shifts, uint pairs, uint triples) {
    float t = min((x - origin) * scale, limit);
    uint cell = uint(int(t > 0.0f ? t : 0.0f));  // what is no number lands in cell 0
    return (kd_spread3(cell & ((1u << triples) - 1u)) << (shifts & 31u)) |
           (kd_spread2((cell >> triples) & ((1u << pairs) - 1u)) << ((shifts >> 8u) & 31u)) |
           ((cell >> (triples + pairs)) << (shifts >> 16u));
}
// The cell of a photon, among its node's, if photons are split by key; and by position. Each step keeps order, whatever it rounds.
FN bool kd_by_key(IN(KdLarge) n) { return n.axes.w != 0u; }
FN uint kd_key_cell(IN(KdLarge) n, uint key) { return (key - ~n.least.w) >> (n.axes.w - 32u); }
FN uint kd_cell(IN(KdLarge) n, vec3 low, vec3 p) {
    return (kd_part(p.x, low.x, n.scale.x, n.limit.x, n.shifts.x, n.shape.y, n.shape.z) |
            kd_part(p.y, low.y, n.scale.y, n.limit.y, n.shifts.y, n.shape.y, n.shape.z) |
            kd_part(p.z, low.z, n.scale.z, n.limit.z, n.shifts.z, n.shape.y, n.shape.z)) >>
           n.shape.w;
}

#endif

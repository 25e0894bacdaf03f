// A tree over photons in Morton order: level 0 has a box for each leaf (a run of photons), each further level a box for
// every four of the level below, up to the root. There are no links: the children of node i are 4i to 4i + 3.
#ifndef LAMPYRIS_PHOTON_BVH
#define LAMPYRIS_PHOTON_BVH

#include "core/kernel/photon.h"

CONST uint TREE_LEVELS = 16u;

struct TreeBox {
    vec4 low;
    vec4 high;
};

struct TreeRecord {
    vec4 origin;        // of the Morton grid; w: cells per unit length, the same along each axis
    vec4 radius;        // x: of the largest query; the boxes for ray queries have this size
    uint count;         // of photons
    uint leaf_photons;  // in a full leaf
    uint level_count;
    uint built_level;           // the level being built
    uvec4 levels[TREE_LEVELS];  // x: first box, y: number of boxes
};

// Spreads the lowest ten bits: two zeros follow each.
FN uint morton_spread(uint x) {
    uint v = x & 0x3ffu;
    v = (v | (v << 16u)) & 0x030000ffu;
    v = (v | (v << 8u)) & 0x0300f00fu;
    v = (v | (v << 4u)) & 0x030c30c3u;
    return (v | (v << 2u)) & 0x09249249u;
}
FN uint morton_coordinate(float x, float origin, float scale) {
    float t = (x - origin) * scale;
    return t > 0.0f ? uint(min(t, 1048575.0f)) : 0u;
}
// The Morton code of the upper ten (shift 10) or the lower ten (shift 0) of the 20 bits of each coordinate.
FN uint morton_code(IN(TreeRecord) b, vec3 p, uint shift) {
    return morton_spread(morton_coordinate(p.x, b.origin.x, b.origin.w) >> shift) |
           (morton_spread(morton_coordinate(p.y, b.origin.y, b.origin.w) >> shift) << 1u) |
           (morton_spread(morton_coordinate(p.z, b.origin.z, b.origin.w) >> shift) << 2u);
}

#endif

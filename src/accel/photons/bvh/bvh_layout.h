// A tree over photons in the order of their Morton codes: level 0 has a box for each leaf (a run of photons), each next level one for
// every four of the level below, up to the root. No links: the children of node i are 4i to 4i + 3.
#ifndef LAMPYRIS_PHOTON_BVH
#define LAMPYRIS_PHOTON_BVH

#include "core/kernel/photon.h"

CONST uint TREE_LEVELS = 16u;

struct TreeBox {
    vec4 low;
    vec4 high;
};

struct TreeRecord {
    vec4 origin;        // of the Morton grid; w: its cells per unit, the same along each axis
    vec4 radius;        // x: of the largest query that boxes about photons are made for
    uint count;         // of photons
    uint leaf_photons;  // of a full leaf
    uint level_count;
    uint built_level;           // the level being built
    uvec4 levels[TREE_LEVELS];  // x: first box, y: number of boxes
};

// Ten bits, two zeros after each.
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
// Of 20 bits a coordinate, the upper ten or the lower ten.
FN uint morton_code(IN(TreeRecord) b, vec3 p, uint shift) {
    return morton_spread(morton_coordinate(p.x, b.origin.x, b.origin.w) >> shift) |
           (morton_spread(morton_coordinate(p.y, b.origin.y, b.origin.w) >> shift) << 1u) |
           (morton_spread(morton_coordinate(p.z, b.origin.z, b.origin.w) >> shift) << 2u);
}

#endif

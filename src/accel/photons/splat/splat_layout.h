// The grid of hit points. As in the sorted grid, only rows are hashed: neighbours along x are neighbours in the table.
#ifndef LAMPYRIS_SPLAT
#define LAMPYRIS_SPLAT

#include "core/kernel/photon_grid.h"

// In the grid, `count` is the number of hit points, and `entries` is a power of two.
struct SplatRecord {
    PhotonGrid grid;
    vec4 scale;  // xyz: from power to fixed point; w: from a count. All are powers of two.
    vec4 reach;  // x: bound for the distance, along each axis, between a hit point and a photon in its range
};

FN uint splat_entry(IN(PhotonGrid) g, uvec3 cell) {
    return (row_hash(cell.y, cell.z, g.resolution.w) + cell.x) & (g.entries - 1u);
}

#endif

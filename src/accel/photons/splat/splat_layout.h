// The hit points' grid: as the sorted grid's, rows are hashed, and their cells are neighbours in the table.
#ifndef LAMPYRIS_SPLAT
#define LAMPYRIS_SPLAT

#include "core/kernel/photon_grid.h"

// Of the grid: `count` hit points, and entries, a power of two.
struct SplatRecord {
    PhotonGrid grid;
    vec4 scale;  // xyz: of a power to fixed point; w: of a count. Exact powers of two.
    vec4 reach;  // x: no hit point is farther from a photon that it sees, per coordinate
};

FN uint splat_entry(IN(PhotonGrid) g, uvec3 cell) {
    return (row_hash(cell.y, cell.z, g.resolution.w) + cell.x) & (g.entries - 1u);
}

#endif

// Grid cells: one function for inserting, testing and querying.
//
// A cell's coordinate is computed by subtraction, multiplication, truncation and clamping. Each of them is monotonic in
// spite of rounding. So a photon between the corners of a query's box is in a cell between the corners' cells, without
// an epsilon.
#ifndef LAMPYRIS_KERNEL_PHOTON_GRID
#define LAMPYRIS_KERNEL_PHOTON_GRID

#include "core/kernel/photon.h"

// NaN maps to cell 0.
FN uint grid_coordinate(float x, float origin, float inverse, uint cells) {
    float t = (x - origin) * inverse;
    return t > 0.0f ? min(uint(min(t, float(GRID_MAX_CELLS))), cells - 1u) : 0u;
}
FN uvec3 grid_cell(IN(PhotonGrid) g, vec3 p) {
    return uvec3(grid_coordinate(p.x, g.origin.x, g.origin.w, g.resolution.x),
                 grid_coordinate(p.y, g.origin.y, g.origin.w, g.resolution.y),
                 grid_coordinate(p.z, g.origin.z, g.origin.w, g.resolution.z));
}
FN bool same_cell(uvec3 a, uvec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

// A cell's hash is that of its row (y, z), mixed with x; neighbours in x share the row's hash. The seed enters before
// the first multiplication, so that it changes which cells collide.
FN uint row_hash(uint y, uint z, uint seed) { return hash32(hash32(z ^ seed) + y * 0x9e3779b1u); }
FN uint cell_hash(uint row, uint x) { return hash32(row + x * 0x85ebca77u); }
// The table entry of a hash: the product's high word, which needs no division and works for any table size.
FN uint hashed_entry(uint hash, uint entries) { return mul_high(hash, entries); }
FN uint grid_entry(IN(PhotonGrid) g, uvec3 cell) {
    return hashed_entry(cell_hash(row_hash(cell.y, cell.z, g.resolution.w), cell.x), g.entries);
}

#endif

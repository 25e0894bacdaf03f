// The table of the sorted grid: cells that are neighbours along x are neighbours in the table.
#ifndef LAMPYRIS_SORTED_GRID
#define LAMPYRIS_SORTED_GRID

#include "core/kernel/photon_grid.h"

// Each row of cells starts at a random entry. The table's size is a power of two.
FN uint sorted_grid_entry(IN(PhotonGrid) g, uvec3 cell) {
    return (row_hash(cell.y, cell.z, g.resolution.w) + cell.x) & (g.entries - 1u);
}

#endif

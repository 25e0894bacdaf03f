// Cells of the uniform grid: `counts` has two words per cell, the number of its photons and the first link of those
// beyond the capacity (a photon's index plus one; 0: none). A slot is a photon's position and, in w, its index.
#ifndef LAMPYRIS_UNIFORM_GRID
#define LAMPYRIS_UNIFORM_GRID

#include "core/kernel/photon_grid.h"

// In PhotonGrid, `entries` is the number of cells; `option` is 1 if photons beyond the capacity are dropped.
FN uint uniform_grid_index(IN(PhotonGrid) g, uvec3 cell) {
    return (cell.z * g.resolution.y + cell.y) * g.resolution.x + cell.x;
}

#endif

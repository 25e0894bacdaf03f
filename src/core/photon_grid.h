// The grid of a pass: where its cells lie, and how large they are.
#pragma once

#include "core/photon_map.h"

namespace lampyris {

// Cells of `multiple` times the largest radius over the photons' box, their origin and the seed of their hash drawn anew for
// each (seed, pass). No axis gets more than kernel::GRID_MAX_CELLS cells, and no cell is smaller than a positive floor: cells grow
// where the radius is tiny.
kernel::PhotonGrid make_grid(const PhotonSet& photons, float multiple);

// Entries of a table with so many per photon: one at least.
uint32_t table_entries(const PhotonSet& photons, float per_photon);

}  // namespace lampyris

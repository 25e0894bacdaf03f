// The grid of a pass: the position and size of its cells.
#pragma once

#include "core/photons/photon_map.h"

namespace lampyris {

// A grid over the photons' box with cells of `multiple` times the largest radius. Its origin and the seed of its hash are drawn
// anew for each (seed, pass). No axis gets more than kernel::GRID_MAX_CELLS cells, and no cell is smaller than a positive
// minimum: cells are enlarged if the radius is tiny.
kernel::PhotonGrid make_grid(const PhotonSet& photons, float multiple);

// The number of entries of a table with `per_photon` entries per photon: at least one.
uint32_t table_entries(const PhotonSet& photons, float per_photon);

}  // namespace lampyris

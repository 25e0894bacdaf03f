// Parameters of the sorted grid.
#ifndef LAMPYRIS_SORTED_GRID_PARAMS
#define LAMPYRIS_SORTED_GRID_PARAMS

#include "core/kernel/params.h"

#define SORTED_GRID_PARAMS(P)                                                          \
    P(float, cell_size, 2, 0.25f, 16, "side of a cell, in radii of the largest query") \
    P(float, table_size, 1, 0.015625f, 16, "entries of the table per photon, at least; rounded up to a power of two")
PARAMS(SortedGridParams, SORTED_GRID_PARAMS)

#endif

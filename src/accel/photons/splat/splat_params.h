// Parameters of splatting.
#ifndef LAMPYRIS_SPLAT_PARAMS
#define LAMPYRIS_SPLAT_PARAMS

#include "core/kernel/params.h"

#define SPLAT_PARAMS(P)                                                                              \
    P(float, cell_size, 2, 0.25f, 16, "side of a cell of hit points, in radii of the largest query") \
    P(float, table_size, 1, 0.015625f, 16, "entries of the table per hit point, at least; rounded up to a power of two")
PARAMS(SplatParams, SPLAT_PARAMS)

#endif

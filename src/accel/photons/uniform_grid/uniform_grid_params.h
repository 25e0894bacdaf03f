// Parameters of the uniform grid.
#ifndef LAMPYRIS_UNIFORM_GRID_PARAMS
#define LAMPYRIS_UNIFORM_GRID_PARAMS

#include "core/kernel/params.h"

#define UNIFORM_GRID_PARAMS(P)                                                                                        \
    P(float, cell_size, 1, 0.25f, 16, "side of a cell, in radii of the largest query; larger if `cells` requires it") \
    P(float, cells, 1, 0.001f, 64,                                                                                    \
      "most cells per photon: the grid covers the whole box, and empty cells cost memory and time")                   \
    P(uint, capacity, 6, 1, 16, "photons that a cell holds; `overflow` says what happens to further ones")            \
    P(uint, overflow, 0, 0, 1,                                                                                        \
      "{list|drop} what happens to photons beyond the capacity; dropped ones are counted, and the others of their "   \
      "cell are weighted up")
PARAMS(UniformGridParams, UNIFORM_GRID_PARAMS)

#endif

// Parameters of the uniform grid.
#ifndef LAMPYRIS_UNIFORM_GRID_PARAMS
#define LAMPYRIS_UNIFORM_GRID_PARAMS

#include "core/kernel/params.h"

#define UNIFORM_GRID_PARAMS(P)                                                                                       \
    P(float, cell_size, 1, 0.25f, 16, "side of a cell, in radii of the largest query; larger where `cells` says so") \
    P(float, cells, 1, 0.001f, 64, "cells per photon, at most: the grid covers the whole box, and empty cells cost") \
    P(uint, capacity, 6, 1, 16, "photons that a cell holds; more of them go to its overflow list")                   \
    P(uint, overflow, 0, 0, 1,                                                                                       \
      "{list|drop} what becomes of photons beyond the capacity; dropped ones are counted, and "                      \
      "the others of their cell stand for them")
PARAMS(UniformGridParams, UNIFORM_GRID_PARAMS)

#endif

// Parameters of stochastic hashing.
#ifndef LAMPYRIS_STOCHASTIC_HASH_PARAMS
#define LAMPYRIS_STOCHASTIC_HASH_PARAMS

#include "core/kernel/params.h"

#define STOCHASTIC_HASH_PARAMS(P)                                                                                   \
    P(uint, selection, 1, 0, 2,                                                                                     \
      "{race|priority|flux} which photons of a bucket are kept: the last one written, as in the paper; those with " \
      "the largest hash of their key; one chosen with a probability proportional to its flux")                      \
    P(uint, slots, 1, 1, 16, "photons that a bucket keeps")                                                         \
    P(float, table_size, 1, 0.0001f, 64, "buckets per photon")                                                      \
    P(float, cell_size, 2, 0.25f, 16, "side of a cell, in radii of the largest query")
PARAMS(StochasticHashParams, STOCHASTIC_HASH_PARAMS)

#endif

// Parameters of bidirectional path tracing.
#ifndef LAMPYRIS_BDPT_PARAMS
#define LAMPYRIS_BDPT_PARAMS

#include "integrators/bidirectional/bidirectional_params.h"

// clang-format off
#define BDPT_PARAMS(P) \
    SUBPATH_PARAMS(P) \
    CONNECTION_PARAMS(P) \
    COUNTS_PARAMS(P) \
    P(uint, weights, 0, 0, 2, \
      "{balance|power|none} heuristic that weighs the strategies; none shows the one chosen by the next two as if it " \
      "were alone") \
    P(int, s, -1, -1, 100000, "only strategies with so many vertices from the light; -1: any") \
    P(int, t, -1, -1, 100000, "only strategies with so many vertices from the camera; -1: any") \
    P(uint, strategies, 0, 0, 1, \
      "{off|on} also keeps images of each strategy, weighed and alone, as layers strategy.s1t3 and alone.s1t3 of the " \
      "image: each takes the passes once more")
// clang-format on
PARAMS(BdptParams, BDPT_PARAMS)

#endif

// Parameters of bidirectional photon mapping.
#ifndef LAMPYRIS_BPM_PARAMS
#define LAMPYRIS_BPM_PARAMS

#include "integrators/bidirectional/bidirectional_params.h"

// clang-format off
#define BPM_PARAMS(P) \
    SUBPATH_PARAMS(P) \
    P(uint, weights, 0, 0, 1, "{balance|power} heuristic that weighs the vertices at which a path may be merged") \
    MERGING_PARAMS(P)
// clang-format on
PARAMS(BpmParams, BPM_PARAMS)

#endif

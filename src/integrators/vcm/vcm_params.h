// Parameters of vertex connection and merging.
#ifndef LAMPYRIS_VCM_PARAMS
#define LAMPYRIS_VCM_PARAMS

#include "integrators/bidirectional/bidirectional_params.h"

// clang-format off
#define VCM_PARAMS(P) \
    SUBPATH_PARAMS(P) \
    CONNECTION_PARAMS(P) \
    COUNTS_PARAMS(P) \
    P(uint, weights, 0, 0, 1, "{balance|power} heuristic that weighs the strategies") \
    MERGING_PARAMS(P)
// clang-format on
PARAMS(VcmParams, VCM_PARAMS)

#endif

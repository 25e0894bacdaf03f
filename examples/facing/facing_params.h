// Parameters of the facing ratio, for both compilers.
#ifndef FACING_PARAMS
#define FACING_PARAMS

#include "core/kernel/params.h"

#define FACING_PARAMS_LIST(P) \
    P(float, power, 1.0f, 0.0f, 100.0f, "exponent of the cosine: large values darken the rims")
PARAMS(FacingParams, FACING_PARAMS_LIST)

#endif

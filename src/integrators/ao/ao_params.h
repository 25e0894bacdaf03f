// Parameters of ambient occlusion.
#ifndef LAMPYRIS_AO_PARAMS
#define LAMPYRIS_AO_PARAMS

#include "core/kernel/params.h"

#define AO_PARAMS(P)                                          \
    P(int, rays, 1, 1, 1024, "occlusion rays per camera hit") \
    P(float, distance, 1e30f, 0.0f, 1e30f, "hits farther away than this do not occlude")
PARAMS(AoParams, AO_PARAMS)

#endif

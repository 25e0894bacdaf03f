// Parameters of light tracing.
#ifndef LAMPYRIS_LIGHT_PARAMS
#define LAMPYRIS_LIGHT_PARAMS

#include "core/kernel/params.h"

#define LIGHT_PARAMS(P)                                                                          \
    P(int, maxdepth, 5, 0, 100000, "most scattering vertices of a path, specular ones included") \
    P(int, lightpaths, -1, -1, 1000000000, "paths from lights in each pass; -1 or 0: as many as the picture has pixels")
PARAMS(LightParams, LIGHT_PARAMS)

#endif

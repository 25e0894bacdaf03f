// Parameters of the path tracer.
#ifndef LAMPYRIS_PATH_PARAMS
#define LAMPYRIS_PATH_PARAMS

#include "core/kernel/params.h"

#define PATH_PARAMS(P)                                                                           \
    P(int, maxdepth, 5, 0, 100000, "most scattering vertices of a path, specular ones included") \
    P(int, rrdepth, 3, 0, 100000, "vertices after which Russian roulette may end a path")
PARAMS(PathParams, PATH_PARAMS)

#endif

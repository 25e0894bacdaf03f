// Parameters of the BVH.
#ifndef LAMPYRIS_BVH_PARAMS
#define LAMPYRIS_BVH_PARAMS

#include "core/kernel/params.h"

#define BVH_PARAMS(P)                                                                                               \
    P(uint, leaf, 8, 1, 64, "photons of a leaf")                                                                    \
    P(uint, ray_query, 0, 0, 2,                                                                                     \
      "{auto|on|off} find photons with VK_KHR_ray_query, in an order that depends on the driver; auto: if it also " \
      "traces the scene's rays")
PARAMS(BvhParams, BVH_PARAMS)

#endif

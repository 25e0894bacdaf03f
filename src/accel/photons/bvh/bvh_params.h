// Parameters of the BVH.
#ifndef LAMPYRIS_BVH_PARAMS
#define LAMPYRIS_BVH_PARAMS

#include "core/kernel/params.h"

#define BVH_PARAMS(P)                                                                                            \
    P(uint, leaf, 8, 1, 64, "photons of a leaf")                                                                 \
    P(uint, ray_query, 0, 0, 2,                                                                                  \
      "{auto|on|off} look photons up with VK_KHR_ray_query, whose order is the driver's; auto: where it traces " \
      "the scene's rays, too")
PARAMS(BvhParams, BVH_PARAMS)

#endif

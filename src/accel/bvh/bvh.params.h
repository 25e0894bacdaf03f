// Parameters of the BVH.
#ifndef LAMPYRIS_BVH_PARAMS
#define LAMPYRIS_BVH_PARAMS

#include "core/kernel/params.h"

#define BVH_PARAMS(P) P(uint, leaf, 8, 1, 64, "photons of a leaf")
PARAMS(BvhParams, BVH_PARAMS)

#endif

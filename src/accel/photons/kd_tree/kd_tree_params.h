// Parameters of the kd-tree.
#ifndef LAMPYRIS_KD_TREE_PARAMS
#define LAMPYRIS_KD_TREE_PARAMS

#include "core/kernel/params.h"

#define KD_TREE_PARAMS(P)                                                                                           \
    P(uint, leaf, 16, 4, 64,                                                                                        \
      "photons per leaf: nodes with at most this many are leaves, and so are cells of a round with up to twice as " \
      "many")
PARAMS(KdTreeParams, KD_TREE_PARAMS)

#endif

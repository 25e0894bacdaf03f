// Parameters of the kd-tree.
#ifndef LAMPYRIS_KD_TREE_PARAMS
#define LAMPYRIS_KD_TREE_PARAMS

#include "core/kernel/params.h"

#define KD_TREE_PARAMS(P)    \
    P(uint, leaf, 16, 4, 64, \
      "photons of a leaf: nodes with no more are not split; what a round leaves with up to twice as many stays")
PARAMS(KdTreeParams, KD_TREE_PARAMS)

#endif

// Parameters of hash grids with chains: linked_list and hash_list.
#ifndef LAMPYRIS_LINKED_LIST_PARAMS
#define LAMPYRIS_LINKED_LIST_PARAMS

#include "core/kernel/params.h"

#define LINKED_LIST_PARAMS(P)                                                                                        \
    P(float, cell_size, 1, 0.25f, 16, "side of a cell, in radii of the largest query")                               \
    P(float, table_size, 1, 0.0001f, 16, "buckets per photon")                                                       \
    P(uint, order, 0, 0, 1,                                                                                          \
      "{keyed|any} order of a chain's photons: by key, so that sums are the same on every machine; or as they were " \
      "linked")
PARAMS(LinkedListParams, LINKED_LIST_PARAMS)

#endif

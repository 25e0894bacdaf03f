// Parameters of cuckoo hashing.
#ifndef LAMPYRIS_CUCKOO_PARAMS
#define LAMPYRIS_CUCKOO_PARAMS

#include "core/kernel/params.h"

#define CUCKOO_PARAMS(P)                                                                    \
    P(float, cell_size, 2, 0.25f, 16, "side of a cell, in radii of the largest query")      \
    P(float, table_size, 1.4f, 1.05f, 16, "entries of the table per cell that has photons") \
    P(uint, stash, 64, 0, 1024, "cells that may remain without an entry before the table is rebuilt")
PARAMS(CuckooParams, CUCKOO_PARAMS)

#endif

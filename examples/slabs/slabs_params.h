// Parameters of the slabs.
#ifndef SLABS_PARAMS
#define SLABS_PARAMS

#include "core/kernel/params.h"

#define SLABS_PARAMS_LIST(P) P(uint, slabs, 64, 1, 4096, "number of slabs")
PARAMS(SlabsParams, SLABS_PARAMS_LIST)

#endif

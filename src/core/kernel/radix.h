// Stable radix sort of (key, value) pairs by 32-bit keys: each block counts its digits, prefix sums give the positions
// of each block's digits, and each block moves its pairs there, in order. One invocation per block: no shared memory,
// and the same code on every machine.
#ifndef LAMPYRIS_KERNEL_RADIX
#define LAMPYRIS_KERNEL_RADIX

#include "core/kernel/prelude.h"

CONST uint RADIX_BITS = 8u;
CONST uint RADIX_DIGITS = 256u;
CONST uint RADIX_BLOCK = 4096u;

#endif

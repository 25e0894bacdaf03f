// Radix sort of (key, value) pairs by 32-bit keys, stable: blocks count their digits, prefix sums say where each block's go,
// and each block moves its pairs there, in order. One invocation a block: no shared memory, the same code on every machine.
#ifndef LAMPYRIS_KERNEL_RADIX
#define LAMPYRIS_KERNEL_RADIX

#include "core/kernel/prelude.h"

CONST uint RADIX_BITS = 8u;
CONST uint RADIX_DIGITS = 256u;
CONST uint RADIX_BLOCK = 4096u;

#endif

// Prefix sums in three steps: the sums of blocks (scan_sum), the prefix sums of those, and prefix sums within each
// block (scan_write).
#ifndef LAMPYRIS_KERNEL_SCAN
#define LAMPYRIS_KERNEL_SCAN

#include "core/kernel/prelude.h"

CONST uint SCAN_BLOCK = 1024u;

BUFFER_RO(0, uvec4, arguments)  // x: number of values, y: number of blocks
BUFFER_RW(1, uint, values)
BUFFER_RW(2, uint, sums)

#endif

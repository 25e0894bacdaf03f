// The sum of each block of values.
#include "core/kernel/scan.h"

KERNEL(scan_sum) {
    uint begin = index * SCAN_BLOCK;
    uint end = min(begin + SCAN_BLOCK, arguments[0].x);
    uint sum = 0u;
    for (uint i = begin; i < end; ++i) sum += values[i];
    sums[index] = sum;
}

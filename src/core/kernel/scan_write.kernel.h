// Replaces each value of a block by the sum of all values before it. `sums` has the sums up to each block; a single
// block does not need it.
#include "core/kernel/scan.h"

KERNEL(scan_write) {
    uint begin = index * SCAN_BLOCK;
    uint end = min(begin + SCAN_BLOCK, arguments[0].x);
    uint sum = arguments[0].y > 1u ? sums[index] : 0u;
    for (uint i = begin; i < end; ++i) {
        uint value = values[i];
        values[i] = sum;
        sum += value;
    }
}

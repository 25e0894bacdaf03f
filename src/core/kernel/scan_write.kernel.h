// Replaces each value of a block by the sum of those before it; `sums` has that of the blocks before, unless there is one block.
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

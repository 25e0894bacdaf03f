// For device_test: sums limits[index] terms in a loop with a bound, and reports if the bound was exceeded.
#include "core/kernel/prelude.h"

BUFFER_RO(0, uint, limits)
BUFFER_RW(1, uint, sums)

KERNEL(device_loop) {
    uint sum = 0u;
    uint i = 0u;
    for (; i < limits[index] && i < 1000u; ++i) sum += i ^ sum;
    if (i < limits[index]) REPORT_UNFINISHED();
    sums[index] = sum;
}

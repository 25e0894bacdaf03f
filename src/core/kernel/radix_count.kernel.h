// One pass of a radix sort, first step: counts how often each digit occurs in each block of keys.
#include "core/kernel/radix.h"

BUFFER_RO(0, uvec4, arguments)  // x: number of pairs, y: number of blocks, z: shift of the digit
BUFFER_RO(1, uvec2, pairs)      // key, value
BUFFER_RW(2, uint, counts)      // [digit][block]

KERNEL(radix_count) {
    uint count = arguments[0].x;
    uint shift = arguments[0].z;
    uint digits[RADIX_DIGITS];
    for (uint d = 0u; d < RADIX_DIGITS; ++d) digits[d] = 0u;
    uint begin = index * RADIX_BLOCK;
    uint end = min(begin + RADIX_BLOCK, count);
    uint i = begin;
    for (; i < end; ++i) digits[(pairs[i].x >> shift) & (RADIX_DIGITS - 1u)] += 1u;
    if (i != end) REPORT_UNFINISHED();
    for (uint d = 0u; d < RADIX_DIGITS; ++d) counts[d * arguments[0].y + index] = digits[d];
}

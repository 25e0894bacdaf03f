// One pass of a radix sort, last step: moves each block's pairs, in order, to the positions of their digits.
#include "core/kernel/radix.h"

BUFFER_RO(0, uvec4, arguments)  // as in radix_count
BUFFER_RO(1, uvec2, pairs)
BUFFER_RO(2, uint, starts)  // [digit][block]
BUFFER_RW(3, uvec2, sorted)

KERNEL(radix_move) {
    uint shift = arguments[0].z;
    uint places[RADIX_DIGITS];
    for (uint d = 0u; d < RADIX_DIGITS; ++d) places[d] = starts[d * arguments[0].y + index];
    uint begin = index * RADIX_BLOCK;
    uint end = min(begin + RADIX_BLOCK, arguments[0].x);
    uint i = begin;
    for (; i < end; ++i) {
        uvec2 pair = pairs[i];
        uint digit = (pair.x >> shift) & (RADIX_DIGITS - 1u);
        sorted[places[digit]] = pair;
        places[digit] += 1u;
    }
    if (i != end) REPORT_UNFINISHED();
}

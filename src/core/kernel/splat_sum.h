// The sums of splats, read back: see splat.h. The kernel declares `splats`.
#ifndef LAMPYRIS_KERNEL_SPLAT_SUM
#define LAMPYRIS_KERNEL_SPLAT_SUM

#include "core/kernel/splat_layout.h"

FN float splat_number(uint low, uint high) {
    bool negative = (high & 0x80000000u) != 0u;
    uint low_size = negative ? ~low + 1u : low;
    uint high_size = negative ? ~high + (low == 0u ? 1u : 0u) : high;
    float size = float(high_size) * 4294967296.0f + float(low_size);
    return negative ? -size : size;
}

// What splats added to a pixel, and how many were lost.
FN vec3 splat_sum(uint pixel, float quantum, OUT(uint) lost) {
    uint at = pixel * SPLAT_WORDS;
    lost = splats[at + SPLAT_LOST];
    return vec3(splat_number(splats[at], splats[at + 1u]), splat_number(splats[at + 2u], splats[at + 3u]),
                splat_number(splats[at + 4u], splats[at + 5u])) *
           quantum;
}

#endif

// The sums of splats, read back: see splat.h. The kernel declares `splats`.
#ifndef LAMPYRIS_KERNEL_SPLAT_SUM
#define LAMPYRIS_KERNEL_SPLAT_SUM

#include "core/kernel/splat_layout.h"

FN float splat_number(uint at) {
    bool negative = (splats[at + SPLAT_NUMBER_WORDS - 1u] & 0x80000000u) != 0u;
    float size = 0.0f;
    float unit_of_word = 1.0f;
    // The size of a negative number is its complement plus 1.
    uint carry = 1u;
    for (uint i = 0u; i < SPLAT_NUMBER_WORDS; ++i) {
        uint word = splats[at + i];
        if (negative) {
            word = ~word + carry;
            carry = word == 0u ? carry : 0u;
        }
        size = float(word) * unit_of_word + size;
        unit_of_word *= 4294967296.0f;
    }
    return negative ? -size : size;
}

// What splats added to a pixel, and how many were lost.
FN vec3 splat_sum(uint pixel, float quantum, OUT(uint) lost) {
    uint at = pixel * SPLAT_WORDS;
    lost = splats[at + SPLAT_LOST];
    return vec3(splat_number(at), splat_number(at + SPLAT_NUMBER_WORDS), splat_number(at + 2u * SPLAT_NUMBER_WORDS)) *
           quantum;
}

#endif

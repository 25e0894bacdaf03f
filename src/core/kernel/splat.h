// Splats: samples that light paths add to any pixel. Sums are integers, so that they do not depend on the order of the
// additions: an image is the same for any number of threads, and on every backend.
//
// The kernel declares `splats`, to write: SPLAT_WORDS for each pixel of the film's window. A colour is a number of 64 bits (two's
// complement, the lower word first) in units of `quantum`; words of 32 bits with a carry, because not every device adds 64.
#ifndef LAMPYRIS_KERNEL_SPLAT
#define LAMPYRIS_KERNEL_SPLAT

#include "core/kernel/splat_layout.h"

FN void splat_add_word(uint at, uint low, uint high) {
    uint before = ATOMIC_ADD_U32(splats[at], low);
    uint carried = high + (before + low < before ? 1u : 0u);
    if (carried != 0u) ATOMIC_ADD_U32(splats[at + 1u], carried);
}

// Adds one number. Rounds up or down by chance, by the uniform number u: many small splats keep their sum in expectation, where
// rounding to the nearest quantum would make it 0.
FN void splat_add_number(uint at, float quanta, float u) {
    float size = abs(quanta);
    float high = floor(size * 2.3283064365386963e-10f);  // 2^-32
    float rest = size - high * 4294967296.0f;            // exact: what `high` leaves of the mantissa
    float whole = floor(rest);
    // A number with a fraction is below 2^24, so that the sum stays within a word.
    uint low_word = uint(whole) + (u < rest - whole ? 1u : 0u);
    uint high_word = uint(high);
    if (quanta < 0.0f) {
        high_word = ~high_word + (low_word == 0u ? 1u : 0u);
        low_word = ~low_word + 1u;
    }
    if ((low_word | high_word) != 0u) splat_add_word(at, low_word, high_word);
}

// Adds a colour (linear Rec. 709) to a pixel. `key` decides how it is rounded: a hash of whatever makes the splat unique.
FN void splat_add(uint pixel, vec3 rgb, float quantum, uint key) {
    vec3 quanta = rgb / quantum;
    uint at = pixel * SPLAT_WORDS;
    if (!(abs(quanta.x) <= SPLAT_LARGEST && abs(quanta.y) <= SPLAT_LARGEST && abs(quanta.z) <= SPLAT_LARGEST)) {
        ATOMIC_ADD_U32(splats[at + SPLAT_LOST], 1u);
        return;
    }
    splat_add_number(at, quanta.x, unit_float(hash_combine(key, 0u)));
    splat_add_number(at + 2u, quanta.y, unit_float(hash_combine(key, 1u)));
    splat_add_number(at + 4u, quanta.z, unit_float(hash_combine(key, 2u)));
}

#endif

// Splats: samples that light paths add to any pixel. Sums are integers, so that they do not depend on the order of the
// additions: an image is the same for any number of threads, and on every backend.
//
// The kernel declares `splats`, to write: SPLAT_WORDS for each pixel of the film's window. Each of a colour's numbers has 128 bits
// (two's complement, the lowest word first) in units of `quantum`: a lamp close to what the camera sees, in a scene of
// kilometres, makes splats of 2^70 quanta. Words of 32 bits with a carry, because not every device adds more.
#ifndef LAMPYRIS_KERNEL_SPLAT
#define LAMPYRIS_KERNEL_SPLAT

#include "core/kernel/splat_layout.h"

// Adds `amount`, in units of the word `word` of the number at `at`, or subtracts it.
FN void splat_add_word(uint at, uint word, uint amount, bool negative) {
    while (amount != 0u && word < SPLAT_NUMBER_WORDS) {
        uint added = negative ? 0u - amount : amount;
        uint before = ATOMIC_ADD_U32(splats[at + word], added);
        // What is carried, or borrowed.
        amount = (negative ? before < amount : before + added < before) ? 1u : 0u;
        word += 1u;
    }
}

// Adds one number. Rounds up or down by chance, by the uniform number u: many small splats keep their sum in expectation, where
// rounding to the nearest quantum would make it 0.
FN void splat_add_number(uint at, float quanta, float u) {
    float size = abs(quanta);
    // A mantissa has 24 bits: those of a number above 2^64 are above the lowest word.
    uint word = 0u;
    if (size >= 1.8446744073709552e19f) {
        size = size * 2.3283064365386963e-10f;  // 2^-32
        word = 1u;
    }
    float high = floor(size * 2.3283064365386963e-10f);
    float rest = size - high * 4294967296.0f;  // exact: what `high` leaves of the mantissa
    float whole = floor(rest);
    // A number with a fraction is below 2^24, so that the sum stays within a word.
    splat_add_word(at, word, uint(whole) + (u < rest - whole ? 1u : 0u), quanta < 0.0f);
    splat_add_word(at, word + 1u, uint(high), quanta < 0.0f);
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
    splat_add_number(at + SPLAT_NUMBER_WORDS, quanta.y, unit_float(hash_combine(key, 1u)));
    splat_add_number(at + 2u * SPLAT_NUMBER_WORDS, quanta.z, unit_float(hash_combine(key, 2u)));
}

#endif

// For spectrum_test: the same with four wavelengths. Only what turns records into spectra and back is written anew.
#define SPECTRUM_OF_FOUR
#include "kernel/spectrum_walk.h"

BUFFER_RO(0, vec4, inputs)
BUFFER_RW(1, vec4, results)

FN Spectrum all_of(vec4 v) { return Spectrum(v.x, v.y, v.z, v.w); }

KERNEL(spectrum_four) {
    uint at = 4u * index;
    Spectrum throughput =
        spectrum_walk(all_of(inputs[at]), all_of(inputs[at + 1u]), all_of(inputs[at + 2u]), inputs[at + 3u].x);
    results[index] = vec4(throughput[0], throughput[1], throughput[2], throughput[3]);
}

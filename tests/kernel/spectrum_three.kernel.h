// For spectrum_test: what a path does with a Spectrum, as all kernels have it.
#include "kernel/spectrum_walk.h"

BUFFER_RO(0, vec4, inputs)  // per walk: n, k and absorption of a metal and a medium, and a cosine
BUFFER_RW(1, vec4, results)

KERNEL(spectrum_three) {
    uint at = 4u * index;
    Spectrum throughput = spectrum_walk(spectrum_of(inputs[at]), spectrum_of(inputs[at + 1u]),
                                        spectrum_of(inputs[at + 2u]), inputs[at + 3u].x);
    results[index] = slot_of(throughput, max_value(throughput));
}

// Where each slab begins in the sorted pairs, by binary search; the last entry is the number of photons.
#include "slabs/slabs_function.h"

BUFFER_RO(0, Slabs, slabs)
BUFFER_RO(1, uvec2, sorted)
BUFFER_RW(2, uint, starts)

KERNEL(slabs_starts) {
    uint low = 0u;
    uint high = slabs[0].photons;
    for (uint step = 0u; step < 32u && low < high; ++step) {
        uint middle = low + (high - low) / 2u;
        if (sorted[middle].x < index)
            low = middle + 1u;
        else
            high = middle;
    }
    starts[index] = low;
}

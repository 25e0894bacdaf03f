// For device_test: x * x + its index, and a count of the invocations.
#include "core/kernel/prelude.h"

BUFFER_RO(0, float, inputs)
BUFFER_RW(1, float, results)
BUFFER_RW(2, uint, counters)

KERNEL(device_square) {
    results[index] = inputs[index] * inputs[index] + float(index);
    ATOMIC_ADD_U32(counters[0], 1u);
}

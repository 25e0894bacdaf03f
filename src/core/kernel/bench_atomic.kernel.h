// The benchmark's floor: a counter at a random place, incremented.
#include "core/kernel/prelude.h"
#include "core/kernel/layout.h"
#include "core/kernel/random.h"

BUFFER_RO(0, uvec4, arguments)  // x: number of points
BUFFER_RW(1, uint, counters)

KERNEL(bench_atomic) {
    uint count = arguments[0].x;
    uint places[BATCH];
    for (uint k = 0u; k < BATCH; ++k) {
        places[k] = mul_high(hash32(batch_item(index, k)), count);
        PREFETCH(counters[places[k]]);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        if (batch_item(index, k) < count) ATOMIC_ADD_U32(counters[places[k]], 1u);
    }
}

// The benchmark's floor: a record of 16 bytes written to a random place.
#include "core/kernel/prelude.h"
#include "core/kernel/layout.h"
#include "core/kernel/random.h"

BUFFER_RO(0, uvec4, arguments)  // x: number of points
BUFFER_RW(1, uvec4, records)

KERNEL(bench_scatter) {
    uint count = arguments[0].x;
    uint places[BATCH];
    for (uint k = 0u; k < BATCH; ++k) {
        places[k] = mul_high(hash32(batch_item(index, k)), count);
        PREFETCH(records[places[k]]);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i < count) records[places[k]] = uvec4(i, places[k], 0u, 0u);
    }
}

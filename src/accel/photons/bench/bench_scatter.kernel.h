// A lower bound for the benchmark: writes one record of 16 bytes to a random index per point.
#include "core/kernel/span.h"
#include "core/kernel/layout.h"
#include "core/kernel/random.h"

BUFFER_RO(0, uvec4, arguments)  // x: number of points
BUFFER_RW(1, uvec4, records)

KERNEL(bench_scatter) {
    uint count = arguments[0].x;
    uint places[2u * BATCH];
    for (uint turn = 0u; turn <= SPAN; ++turn) {
        for (uint k = 0u; k < BATCH && turn < SPAN; ++k) {
            uint place = mul_high(hash32(span_item(index, turn, k)), count);
            places[span_room(turn, k)] = place;
            PREFETCH(records[place]);
        }
        for (uint k = 0u; k < BATCH && turn > 0u; ++k) {
            uint i = span_item(index, turn - 1u, k);
            uint place = places[span_room(turn - 1u, k)];
            if (i < count) records[place] = uvec4(i, place, 0u, 0u);
        }
    }
}

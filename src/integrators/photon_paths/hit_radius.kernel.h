// Computes each hit point's radius for this pass, clears its gathered flux, and finds the box in which photons are
// needed.
#include "core/kernel/prelude.h"
#include "core/kernel/layout.h"
#include "core/kernel/math.h"
#include "integrators/photon_paths/hit_record.h"

BUFFER_RO(0, PhotonPathParams, params)
BUFFER_RO(1, PhotonPass, passes)
BUFFER_RO(2, HitPointRecord, hits)
BUFFER_RW(3, vec4, queries)
BUFFER_RO(4, vec2, statistics)
BUFFER_RW(5, vec4, gathered)
BUFFER_RW(6, uint, counters)
BUFFER_RW(7, vec4, biases)

// Maps floats to integers that have the same order.
FN uint ordered_bits(float x) {
    uint bits = floatBitsToUint(x);
    return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}

// Most hit points change nothing: test before an atomic operation claims the cache line.
FN void raise(uint counter, uint value) {
    if (value > counters[counter]) ATOMIC_MAX_U32(counters[counter], value);
}

KERNEL(hit_radius) {
    gathered[index] = vec4(0.0f);
    biases[index] = vec4(0.0f);
    vec4 q = queries[index];
    if (q.w < 0.0f) return;
    float scale = params[0].schedule == SCHEDULE_MEMORYLESS ? passes[0].squared_scale : statistics[index].x;
    q.w = max(hit_first_radius(hits[index]) * sqrt(scale), hit_least_radius(hits[index]));
    queries[index] = q;
    float reach = q.w * 1.00001f;
    raise(HIT_BOX_LOW, ~ordered_bits(q.x - reach));
    raise(HIT_BOX_LOW + 1u, ~ordered_bits(q.y - reach));
    raise(HIT_BOX_LOW + 2u, ~ordered_bits(q.z - reach));
    raise(HIT_BOX_HIGH, ordered_bits(q.x + reach));
    raise(HIT_BOX_HIGH + 1u, ordered_bits(q.y + reach));
    raise(HIT_BOX_HIGH + 2u, ordered_bits(q.z + reach));
    raise(HIT_LARGEST_RADIUS, floatBitsToUint(q.w));
}

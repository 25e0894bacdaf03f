// Control flow in which invocations go different ways, for tests.
#include "core/kernel/prelude.h"

BUFFER_RO(0, uint, numbers)
BUFFER_RW(1, uint, results)  // 8 for each invocation
BUFFER_RW(2, uint, sums)
BUFFER_RW(3, uint64, wide_sums)

PRIVATE(uint, digits, 10)

FN uint first_divisor(uint x) {
    for (uint d = 2u; d * d <= x; ++d)
        if (x % d == 0u) return d;
    return x;
}

KERNEL(vectors_probe) {
    uint x = numbers[index];
    ATOMIC_ADD_U32(sums[x % 4u], x);
    if (x % 17u == 3u) return;  // keeps results as they are

    // Loops that invocations leave at different times, and numbers that they take along.
    uint turns = 0u;
    uint y = x;
    uint largest = x;
    while (y != 1u && turns < 60u) {
        y = (y & 1u) != 0u ? 3u * y + 1u : y / 2u;
        largest = max(largest, y);
        ++turns;
    }
    results[8u * index] = turns;
    results[8u * index + 1u] = largest;

    // Loops in loops, with turns that are cut short, and a variable that has a value only after some turn.
    uint last = 0u;
    uint kept;
    bool has_kept = false;
    for (uint i = 0u; i < x % 13u; ++i) {
        if (i % 3u == 1u) continue;
        for (uint k = 0u; k < 5u; ++k) {
            if (k == i) break;
            if (has_kept) last = last * 31u + kept;
            if ((x >> k & 1u) == 0u) continue;
            last += i * k;
        }
        if (i == 7u) {
            last ^= 0x5555u;
            break;
        }
        if ((x & 2u) != 0u && i == 2u) {
            kept = x + i;
            has_kept = true;
        }
    }
    results[8u * index + 2u] = last;
    results[8u * index + 3u] = first_divisor(x % 1000u);

    // Arrays by index, and divisions that other invocations could not make.
    for (uint i = 0u; i < 10u; ++i) digits[i] = 0u;
    for (uint rest = x; rest != 0u; rest /= 10u) digits[rest % 10u] += 1u;
    uint most = 0u;
    for (uint i = 0u; i < 10u; ++i)
        if (digits[i] > digits[most]) most = i;
    results[8u * index + 4u] = most;
    uint quotient = 0u;
    if (x % 5u != 0u) quotient = 1000000u / (x % 5u);
    results[8u * index + 5u] = quotient;

    // Numbers of 64 bits.
    uint64 wide = uint64(float(x) * 1048577.0f) * uint64(3u) + (uint64(x) << 7);
    ATOMIC_ADD_U64(wide_sums[x % 4u], wide);
    ATOMIC_MAX_U64(wide_sums[4u + x % 4u], wide);
    results[8u * index + 5u] ^= uint(wide) ^ uint(wide >> 32);

    // Conversions, and a minimum of what may be no number.
    float f = float(x) * 1.7f - 3.0e9f;
    results[8u * index + 6u] = uint(int(f / 2.0f)) + uint(max(f, 0.0f));
    float undefined = (float(x % 3u) - 1.0f) / 0.0f;
    results[8u * index + 7u] = floatBitsToUint(min(float(x), undefined)) ^ floatBitsToUint(sqrt(float(x)));
}

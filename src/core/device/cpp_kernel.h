// The C++ side of the kernel dialect: GLSL's types and functions, from GLM. Only generated files include it.
#pragma once

// Kernels call the tracer that their device hands over, unless the including file names another.
#ifndef KERNEL_TRACER_bvh2
#define KERNEL_TRACER_calls 1
#endif

#include "core/device/kernel_registry.h"
#include "core/device/kernel_types.h"

#include <glm/glm.hpp>

#include <atomic>
#include <bit>
#include <cstdint>
#include <cstring>

namespace lampyris::kernel {

using glm::ivec2;
using glm::mat3;
using glm::uvec2;
using glm::uvec3;

using glm::all;
using glm::any;
using glm::ceil;
using glm::clamp;
using glm::cross;
using glm::dot;
using glm::equal;
using glm::floor;
using glm::greaterThan;
using glm::lessThan;
using glm::max;
using glm::min;
using glm::sqrt;

inline uint floatBitsToUint(float x) { return std::bit_cast<uint>(x); }
inline float uintBitsToFloat(uint x) { return std::bit_cast<float>(x); }
inline int floatBitsToInt(float x) { return std::bit_cast<int>(x); }
inline float intBitsToFloat(int x) { return std::bit_cast<float>(x); }
inline uint bitfieldReverse(uint x) {
    x = __builtin_bswap32(x);
    x = ((x & 0x0f0f0f0fu) << 4u) | ((x & 0xf0f0f0f0u) >> 4u);
    x = ((x & 0x33333333u) << 2u) | ((x & 0xccccccccu) >> 2u);
    return ((x & 0x55555555u) << 1u) | ((x & 0xaaaaaaaau) >> 1u);
}
// Both at once, in one 64-bit register.
inline uvec2 bitfieldReverse(uvec2 v) {
    uint64_t x = __builtin_bswap64((uint64_t(v.x) << 32u) | v.y);
    x = ((x & 0x0f0f0f0f0f0f0f0fu) << 4u) | ((x >> 4u) & 0x0f0f0f0f0f0f0f0fu);
    x = ((x & 0x3333333333333333u) << 2u) | ((x >> 2u) & 0x3333333333333333u);
    x = ((x & 0x5555555555555555u) << 1u) | ((x >> 1u) & 0x5555555555555555u);
    return uvec2(uint(x), uint(x >> 32u));
}
// GLM's abs is `x >= 0 ? x : -x`: a comparison and a selection, although clearing one bit suffices.
inline float abs(float x) { return __builtin_fabsf(x); }
inline int abs(int x) { return x < 0 ? -x : x; }
inline vec2 abs(vec2 v) { return vec2(abs(v.x), abs(v.y)); }
inline vec3 abs(vec3 v) { return vec3(abs(v.x), abs(v.y), abs(v.z)); }
inline vec4 abs(vec4 v) { return vec4(abs(v.x), abs(v.y), abs(v.z), abs(v.w)); }
inline bool isnan(float x) { return x != x; }
inline bool isinf(float x) { return abs(x) > 3.4028235e38f; }
// High word of the product.
inline uint mul_high(uint a, uint b) { return uint(uint64_t(a) * b >> 32); }

using uint64 = uint64_t;
template <typename T>
T atomic_add(T* place, T value) {
    return std::atomic_ref<T>(*place).fetch_add(value, std::memory_order_relaxed);
}
template <typename T>
T atomic_max(T* place, T value) {
    std::atomic_ref<T> word(*place);
    T old = word.load(std::memory_order_relaxed);
    while (old < value && !word.compare_exchange_weak(old, value, std::memory_order_relaxed)) {}
    return old;
}
inline uint atomic_add_u32(uint* place, uint value) { return atomic_add<uint>(place, value); }
inline uint64 atomic_add_u64(uint64* place, uint64 value) { return atomic_add<uint64>(place, value); }
inline uint atomic_max_u32(uint* place, uint value) { return atomic_max<uint>(place, value); }
inline uint64 atomic_max_u64(uint64* place, uint64 value) { return atomic_max<uint64>(place, value); }
inline uint atomic_or_u32(uint* place, uint value) {
    return std::atomic_ref<uint>(*place).fetch_or(value, std::memory_order_relaxed);
}
inline uint atomic_exchange_u32(uint* place, uint value) {
    return std::atomic_ref<uint>(*place).exchange(value, std::memory_order_relaxed);
}
inline uint atomic_compare_swap_u32(uint* place, uint expected, uint value) {
    std::atomic_ref<uint>(*place).compare_exchange_strong(expected, value, std::memory_order_relaxed);
    return expected;
}
inline void atomic_store_u32(uint* place, uint value) {
    std::atomic_ref<uint>(*place).store(value, std::memory_order_relaxed);
}
struct VecPair {
    vec4 first;
    vec4 second;
};
inline void report_unfinished(uint* flag) {
    if (flag) atomic_or_u32(flag, 1u);
}

}  // namespace lampyris::kernel
#include "core/kernel/prelude.h"

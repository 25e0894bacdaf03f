// The kernel dialect: the common subset of GLSL and C++20 in which every kernel is written once.
//
// glslang compiles kernel files to SPIR-V; the C++ compiler builds the same files inside a class template
// (`template <EffectSet kEffects> struct Kernel { ... };`, see cpp_kernel.h), where buffers become member pointers.
// This is the only kernel file that asks which of the two compilers reads it. docs/kernel-dialect.md explains the rules.
#ifndef LAMPYRIS_KERNEL_PRELUDE
#define LAMPYRIS_KERNEL_PRELUDE

#ifdef __cplusplus
// Spectrum (core/device/spectrum.h) has three values, or four in a kernel that defines SPECTRUM_OF_FOUR before it includes anything.
#define SPECTRUM_TYPE(size) using Spectrum = SpectrumOf<size>;
// Parameters of functions: IN for structs that are only read, OUT and INOUT for results. Pass vectors and scalars by value.
#define IN(T) const T&
#define OUT(T) T&
#define INOUT(T) T&
#define CONST static constexpr
// A function that few scenes call. C++ compilers do not inline it: what it needs takes no registers from what all scenes run.
// Give it copies of structs: one whose address is known to another function stays in memory.
#define RARE_FN inline __attribute__((noinline))
#define RARELY(condition) __builtin_expect((condition), false)
#ifdef KERNEL_INLINE_ALL
#define FN inline __attribute__((always_inline))
#else
#define FN inline
#endif
// Buffers of the scene (set 0) and of the kernel (set 1): `scene_buffers_` and `kernel_buffers_` are the instance's two tables. The
// latter hears each buffer's name and the size of its elements, for who runs the kernel names what it gives.
#define SCENE_RO(binding_, T, name) const T* __restrict name = static_cast<const T*>(scene_buffers_[binding_]);
// An array of pairs of vec4, which READ_PAIR reads as a VecPair at once (see below).
#define SCENE_RO_PAIRS(binding_, name) SCENE_RO(binding_, VecPair, name)
#define READ_PAIR(name, i) name[i]
#define BUFFER_RO(binding_, T, name) \
    const T* __restrict name = static_cast<const T*>(kernel_buffers_.at(binding_, #name, sizeof(T)));
#define BUFFER_RW(binding_, T, name) \
    T* __restrict name = static_cast<T*>(kernel_buffers_.at(binding_, #name, sizeof(T)));
#define HAS(effect) ((kEffects & (effect)) != 0u)
#define EFFECTS_LOW(effects) uint(effects)
#define EFFECTS_HIGH(effects) uint((effects) >> 32u)
// An array of the invocation's own that several functions use; what it holds is indeterminate at first. GLSL copies a struct with an
// array, element by element, at each call that it is given to.
#define PRIVATE(T, name, count) T name[count] = {};
// The function that runs once per index; one per kernel file.
#define KERNEL(name) inline void kernel_main(uint index)
// Atomics return the old value. ATOMIC_STORE_U32 is for words that several invocations race for, in which any of them may win.
#define ATOMIC_ADD_U32(place, value) atomic_add_u32(&(place), value)
#define ATOMIC_OR_U32(place, value) atomic_or_u32(&(place), value)
#define ATOMIC_MAX_U32(place, value) atomic_max_u32(&(place), value)
#define ATOMIC_EXCHANGE_U32(place, value) atomic_exchange_u32(&(place), value)
#define ATOMIC_COMPARE_SWAP_U32(place, expected, value) atomic_compare_swap_u32(&(place), expected, value)
#define ATOMIC_STORE_U32(place, value) atomic_store_u32(&(place), value)
// On 64 bits: a device may lack them (DeviceFeature::kInt64Atomics).
#define ATOMIC_ADD_U64(place, value) atomic_add_u64(&(place), value)
#define ATOMIC_MAX_U64(place, value) atomic_max_u64(&(place), value)
// Says that a place will be read or written soon; a GPU hides the latency by itself.
#define PREFETCH(place) __builtin_prefetch(&(place))
// A kernel says that it could not do all of its work (a loop's bound or a stack was not enough, or the driver ended a loop
// early: Mesa 22 does after 65,535 iterations). Device::run then throws; an image is never silently dark.
#define REPORT_UNFINISHED() report_unfinished(unfinished_)
CONST bool DRIVERS_END_LOOPS = false;
#else
#define IN(T) in T
#define OUT(T) out T
#define INOUT(T) inout T
#define CONST const
#define SPECTRUM_TYPE(size)
#ifdef SPECTRUM_OF_FOUR
#define Spectrum vec4
#else
#define Spectrum vec3
#endif
#define FN
#define RARE_FN
#define RARELY(condition) (condition)
#define SCENE_RO(binding_, T, name) \
    layout(std430, set = 0, binding = binding_) readonly restrict buffer name##Block { T name[]; };
#ifdef KERNEL_WIDE_READS
// A driver that is a CPU reads component after component of lane after lane, and checks each place against the buffer's size:
// half as many, twice as wide, are cheaper.
#define SCENE_RO_PAIRS(binding_, name) SCENE_RO(binding_, u64vec4, name)
#define READ_PAIR(name, i) pair_of_words(name[i])
#else
#define SCENE_RO_PAIRS(binding_, name) SCENE_RO(binding_, VecPair, name)
#define READ_PAIR(name, i) name[i]
#endif
#define BUFFER_RO(binding_, T, name) \
    layout(std430, set = 1, binding = binding_) readonly restrict buffer name##Block { T name[]; };
#define BUFFER_RW(binding_, T, name) \
    layout(std430, set = 1, binding = binding_) restrict buffer name##Block { T name[]; };
#define HAS(effect) (((kEffects & (effect)).x | (kEffects & (effect)).y) != 0u)
#define EFFECTS_LOW(effects) (effects).x
#define EFFECTS_HIGH(effects) (effects).y
#define PRIVATE(T, name, count) T name[count];
#define KERNEL(name) void kernel_main(uint index)
#define ATOMIC_ADD_U32(place, value) atomicAdd(place, value)
#define ATOMIC_OR_U32(place, value) atomicOr(place, value)
#define ATOMIC_MAX_U32(place, value) atomicMax(place, value)
#define ATOMIC_EXCHANGE_U32(place, value) atomicExchange(place, value)
#define ATOMIC_COMPARE_SWAP_U32(place, expected, value) atomicCompSwap(place, expected, value)
#define ATOMIC_STORE_U32(place, value) place = value
#define uint64 uint64_t
#define ATOMIC_ADD_U64(place, value) atomicAdd(place, value)
#define ATOMIC_MAX_U64(place, value) atomicMax(place, value)
#define PREFETCH(place)
layout(std430, set = 0, binding = 17) restrict buffer UnfinishedBlock { uint unfinished_[]; };
#define REPORT_UNFINISHED() atomicOr(unfinished_[0], 1u)
const bool DRIVERS_END_LOOPS = true;
uint mul_high(uint a, uint b) {
    uint high;
    uint low;
    umulExtended(a, b, high, low);
    return high;
}
struct VecPair {
    vec4 first;
    vec4 second;
};
#ifdef KERNEL_WIDE_READS
vec4 vec_of_words(u64vec2 w) { return uintBitsToFloat(uvec4(unpackUint2x32(w.x), unpackUint2x32(w.y))); }
VecPair pair_of_words(u64vec4 w) { return VecPair(vec_of_words(w.xy), vec_of_words(w.zw)); }
#endif
#endif

// Kernels that touch memory at random handle BATCH items an invocation, so that the CPU can ask for all of their places
// before it uses the first. The k-th item of an invocation lies where each kind of machine likes to read: next to the one before on a
// CPU, next to the neighbouring invocation's on a GPU. The host runs batch_count(n) invocations (core/device/device.h); an item may
// lie beyond the last one.
CONST uint BATCH = 16u;
#ifdef __cplusplus
FN uint batch_item(uint index, uint k) { return index * BATCH + k; }
#else
FN uint batch_item(uint index, uint k) { return (index / 32u) * (32u * BATCH) + k * 32u + index % 32u; }
#endif

#endif

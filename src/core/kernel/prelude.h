// The kernel dialect: the common subset of GLSL and C++20 in which every kernel is written once.
//
// glslang compiles kernel files to SPIR-V; the C++ compiler builds the same files inside a class template
// (`template <EffectSet kEffects> struct Kernel { ... };`, see cpp_kernel.h), where buffers become member pointers.
// Only this file and scene.h test which of the two compilers reads them. docs/kernel-dialect.md explains the rules.
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
// A function that few scenes call. C++ compilers do not inline it, so that it takes no registers from code that all
// scenes run. Pass it copies of structs: a struct whose address another function gets stays in memory.
#define RARE_FN inline __attribute__((noinline))
#define RARELY(condition) __builtin_expect((condition), false)
// A function that C++ compilers inline always: one that is small, or whose constant arguments remove most of it.
#define INLINED_FN inline __attribute__((always_inline))
// Whether a RARE_FN is a function of its own; if not, every call adds its code to the kernel once more.
#define SEPARATE_FUNCTIONS 1
#ifdef KERNEL_INLINE_ALL
#define FN INLINED_FN
#else
#define FN inline
#endif
// Buffers of the scene (set 0) and of the kernel (set 1): `scene_buffers_` and `kernel_buffers_` are the tables of a
// Kernel instance. The latter also gets each buffer's name and element size, because callers pass buffers by name.
#define SCENE_RO(binding_, T, name) const T* __restrict name = static_cast<const T*>(scene_buffers_[binding_]);
#define SCENE_RW(binding_, T, name) T* __restrict name = static_cast<T*>(scene_buffers_[binding_]);
// An array of pairs of vec4. READ_PAIR reads one pair at once, as a VecPair (see below).
#define SCENE_RO_PAIRS(binding_, name) SCENE_RO(binding_, VecPair, name)
#define READ_PAIR(name, i) name[i]
#define BUFFER_RO(binding_, T, name) \
    const T* __restrict name = static_cast<const T*>(kernel_buffers_.at(binding_, #name, sizeof(T)));
#define BUFFER_RW(binding_, T, name) \
    T* __restrict name = static_cast<T*>(kernel_buffers_.at(binding_, #name, sizeof(T)));
#define HAS(effect) ((kEffects & (effect)) != 0u)
#define EFFECTS_LOW(effects) uint(effects)
#define EFFECTS_HIGH(effects) uint((effects) >> 32u)
// An array per invocation that several functions use; its initial values are indeterminate. (GLSL would copy a struct
// with an array, element by element, at each call that it is passed to.)
#define PRIVATE(T, name, count) T name[count] = {};
// The function that runs once per index; one per kernel file.
#define KERNEL(name) inline void kernel_main(uint index)
// Atomics return the old value. ATOMIC_STORE_U32 is for words to which several invocations write at once; any of them
// may win.
#define ATOMIC_ADD_U32(place, value) atomic_add_u32(&(place), value)
#define ATOMIC_OR_U32(place, value) atomic_or_u32(&(place), value)
#define ATOMIC_MAX_U32(place, value) atomic_max_u32(&(place), value)
#define ATOMIC_EXCHANGE_U32(place, value) atomic_exchange_u32(&(place), value)
#define ATOMIC_COMPARE_SWAP_U32(place, expected, value) atomic_compare_swap_u32(&(place), expected, value)
#define ATOMIC_STORE_U32(place, value) atomic_store_u32(&(place), value)
// 64-bit atomics, which a device may lack (DeviceFeature::kInt64Atomics).
#define ATOMIC_ADD_U64(place, value) atomic_add_u64(&(place), value)
#define ATOMIC_MAX_U64(place, value) atomic_max_u64(&(place), value)
// Announces that `place` will soon be read or written; a GPU hides the latency by itself.
#define PREFETCH(place) __builtin_prefetch(&(place))
// Reports that the kernel could not finish its work: a loop's bound or a stack was too small, or the driver ended a
// loop early (Mesa 22 does after 65,535 iterations). Device::run then throws, so that an image is never silently too
// dark.
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
#define INLINED_FN
#define RARELY(condition) (condition)
#define SEPARATE_FUNCTIONS 0
#define SCENE_RO(binding_, T, name) \
    layout(std430, set = 0, binding = binding_) readonly restrict buffer name##Block { T name[]; };
#define SCENE_RW(binding_, T, name) \
    layout(std430, set = 0, binding = binding_) restrict buffer name##Block { T name[]; };
#ifdef KERNEL_WIDE_READS
// A CPU driver reads the components of each lane one by one, and checks each against the buffer's size: half as many
// reads of twice the width are cheaper.
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

// Kernels that access memory at random handle BATCH items per invocation, so that the CPU can prefetch all of them
// before it uses the first. On a CPU, an invocation's items are adjacent. On a GPU, item k is adjacent to the k-th item
// of the neighbouring invocation, so that accesses coalesce. The host runs batch_count(n) invocations (core/device/device.h);
// the last items may be beyond n.
CONST uint BATCH = 16u;
#ifdef __cplusplus
FN uint batch_item(uint index, uint k) { return index * BATCH + k; }
#else
FN uint batch_item(uint index, uint k) { return (index / 32u) * (32u * BATCH) + k * 32u + index % 32u; }
#endif

#endif

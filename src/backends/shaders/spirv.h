// Lampyris's own SPIR-V passes: forbidding contraction, exact quotients and roots, and finding out which buffers a kernel uses.
#pragma once

#include <glslang/SPIRV/spirv.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lampyris::shaders {

using Spirv = std::vector<uint32_t>;

constexpr size_t kHeaderWords = 5;

// Calls visit(opcode, words, count) for each instruction.
template <typename Visit>
void for_each_instruction(const Spirv& spirv, Visit&& visit) {
    for (size_t at = kHeaderWords; at < spirv.size();) {
        const uint32_t count = spirv[at] >> 16;
        if (count == 0 || at + count > spirv.size()) return;  // not SPIR-V; the validator reports it better
        visit(static_cast<spv::Op>(spirv[at] & 0xffffu), &spirv[at], count);
        at += count;
    }
}

// Decorations, and the instructions that precede them in a module (SPIR-V specification, 2.4).
bool is_annotation(spv::Op op);
bool precedes_annotations(spv::Op op);

// Decorates every floating-point arithmetic result with NoContraction, so that neither the optimizer nor a driver contracts or
// reassociates. Bit equality with the CPU depends on it. Idempotent.
Spirv forbid_contraction(const Spirv& spirv);

// Replaces every quotient and square root of floats by calls to the functions of core/kernel/exact.glsl, which must be in the
// module. With `flush_denormals`, their denormals are flushed to zero (the device must offer shaderDenormFlushToZeroFloat32).
Spirv exact_arithmetic(const Spirv& spirv, bool flush_denormals);

struct ShaderBinding {
    uint32_t set = 0, binding = 0;
    bool acceleration_structure = false;  // otherwise a storage buffer
    std::string name;                     // its name in the kernel
    bool operator==(const ShaderBinding&) const = default;
};
// The bindings that the module's functions use, in order of set and binding.
std::vector<ShaderBinding> used_bindings(const Spirv& spirv);

}  // namespace lampyris::shaders

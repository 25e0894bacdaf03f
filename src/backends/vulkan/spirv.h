// What Lampyris does to SPIR-V itself: forbidding contraction, and reading which buffers a kernel uses.
#pragma once

#include <cstdint>
#include <vector>

namespace lampyris::vulkan {

using Spirv = std::vector<uint32_t>;

// Decorates every floating-point arithmetic result NoContraction, so that neither the optimizer nor a driver contracts or
// reassociates: bit equality with the CPU rests on it. Idempotent.
Spirv forbid_contraction(const Spirv& spirv);

struct ShaderBinding {
    uint32_t set = 0, binding = 0;
    bool acceleration_structure = false;  // otherwise a storage buffer
    bool operator==(const ShaderBinding&) const = default;
};
// The bindings that the module's functions use, in order of set and binding.
std::vector<ShaderBinding> used_bindings(const Spirv& spirv);

}  // namespace lampyris::vulkan

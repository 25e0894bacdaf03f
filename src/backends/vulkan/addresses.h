// Buffers that are too large for a device to bind: a kernel's SPIR-V is changed so that it accesses them by their addresses.
#pragma once

#include "backends/shaders/spirv.h"

#include <cstdint>
#include <span>

namespace lampyris::vulkan {

using shaders::ShaderBinding;
using shaders::Spirv;

// The push constants of a kernel (core/kernel/entry.glsl); the addresses follow, 64 bits each.
struct KernelRange {
    uint32_t begin, count;
};

// The alignment of a buffer's address, which is declared for loads and stores.
constexpr uint32_t kAddressAlignment = 16;

// Replaces the storage buffers of these bindings (all of them used by the module) by buffer device addresses: push constants
// after KernelRange, in the order of `bindings`. Offsets are computed in 64 bits, so that a buffer may have any size. Works on
// modules before and after the optimizer. The device must have enabled bufferDeviceAddress and shaderInt64.
Spirv address_buffers(const Spirv& spirv, std::span<const ShaderBinding> bindings);

}  // namespace lampyris::vulkan

// Kernels that run eight invocations at once, compiled by LLVM for exactly a scene's effects. They give the scalar builds' results
// to the bit. docs/decisions/vectors.md
#pragma once

#include "core/device/kernel_registry.h"

#include <cstdint>
#include <memory>
#include <string_view>

namespace lampyris::vectors {

class VectorKernel {
 public:
    virtual ~VectorKernel() = default;
    virtual void run(const CpuInvocation& call) const = 0;
};

// Throws NotTranslated (spirv_program.h), with the reason, for a kernel that does what the translator does not know.
std::shared_ptr<const VectorKernel> compile_vector_kernel(std::string_view file, uint64_t effects);

}  // namespace lampyris::vectors

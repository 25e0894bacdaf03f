// The functions of core/kernel/scene.h for host code. Only source files include this: each gets functions of its own.
#pragma once

#include "core/device/cpp_kernel.h"

namespace lampyris::kernel {
namespace {

template <EffectSet kEffects>
struct SceneKernel {
    void* const* scene_buffers_;
    KernelBufferTable kernel_buffers_;
    const CpuTracer* tracer_;
    uint* unfinished_;
#include "core/kernel/scene.h"
};

}  // namespace
}  // namespace lampyris::kernel

// A compiled kernel on a Vulkan device, and its dispatches.
#pragma once

#include "backends/shaders/shader_compiler.h"
#include "backends/vulkan/pipeline.h"
#include "core/device/kernel_types.h"

#include <functional>
#include <map>
#include <span>

namespace lampyris::vulkan {

using shaders::CompiledShader;

// Set 0: the scene (core/kernel/scene_buffers.h).
struct SceneBindings {
    std::vector<KernelBinding> buffers = std::vector<KernelBinding>(kernel::SCENE_BINDINGS);
    vk::AccelerationStructureKHR top_level;
};

class VulkanKernel final : public Kernel {
 public:
    VulkanKernel(std::shared_ptr<Context> context, const std::string& file, CompiledShader shader, uint32_t local_size);

    struct Spent {
        double compile_s = 0, kernel_s = 0;  // kernel_s: on the device
    };
    // Runs indices [begin, begin + count) in dispatches of about kDispatchSeconds, so that no watchdog trips; ends early if
    // `stop` returns true after a dispatch. The pipeline depends on which buffers are too large to be bound, and is made on
    // first use.
    Spent run(const SceneBindings& scene, std::span<const KernelBinding> buffers, uint32_t begin, uint32_t count,
              const std::function<bool()>& stop) const;
    // Makes the pipeline in which all buffers are bound; `anything` is a placeholder for each of them.
    void prepare(const SceneBindings& scene, vk::Buffer anything) const;

    size_t spirv_bytes() const { return shader_.spirv.size() * sizeof(uint32_t); }
    bool from_cache() const { return shader_.from_cache; }
    bool uses_acceleration_structure() const;
    bool uses_scene() const;

 private:
    // The compiled pipeline, with its buffers bound. `tell`: announce a compilation.
    KernelPipeline& pipeline(const SceneBindings& scene, std::span<const KernelBinding> buffers, bool tell) const;

    std::shared_ptr<Context> context_;
    CompiledShader shader_;
    uint32_t local_size_ = 64;
    std::vector<ShaderBinding> bindings_;
    mutable std::map<Addressed, std::unique_ptr<KernelPipeline>> pipelines_;
    mutable uint32_t chunk_ = 0;  // indices of the next dispatch
};

}  // namespace lampyris::vulkan

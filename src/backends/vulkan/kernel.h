// A compiled kernel on a Vulkan device, and its dispatches.
#pragma once

#include "backends/vulkan/memory.h"
#include "backends/vulkan/shader_compiler.h"

#include <span>

namespace lampyris::vulkan {

// Set 0: the scene. Bindings 0 to 15 and 18 are those of core/kernel/bindings.h.
constexpr uint32_t kTopLevelBinding = 16;    // acceleration structure, with ray query
constexpr uint32_t kUnfinishedBinding = 17;  // see REPORT_UNFINISHED in core/kernel/prelude.h
constexpr uint32_t kSceneBindings = 19;

struct SceneBindings {
    std::vector<vk::Buffer> buffers = std::vector<vk::Buffer>(kSceneBindings);
    vk::AccelerationStructureKHR top_level;
};

// What is bound to a binding of set 1: a buffer, or the structure over the boxes in it, whichever the kernel asks for.
struct KernelBinding {
    vk::Buffer buffer;
    vk::AccelerationStructureKHR structure;
};

class VulkanKernel final : public Kernel {
 public:
    VulkanKernel(std::shared_ptr<Context> context, std::string file, const CompiledShader& shader, uint32_t local_size);

    // Runs indices [begin, begin + count) in dispatches of about kDispatchSeconds, so that no watchdog trips. Returns the
    // seconds on the device.
    double run(const SceneBindings& scene, std::span<const KernelBinding> buffers, uint32_t begin,
               uint32_t count) const;

    // Runs no index: some drivers (lavapipe) compile at the first dispatch. `anything` stands in for every buffer.
    void warm_up(const SceneBindings& scene, vk::Buffer anything) const;

    const std::string& file() const { return file_; }
    size_t spirv_bytes() const { return spirv_bytes_; }
    bool from_cache() const { return from_cache_; }
    bool uses_acceleration_structure() const;
    bool uses_scene() const;
    uint32_t dispatches() const { return dispatches_; }

 private:
    void bind(const SceneBindings& scene, std::span<const KernelBinding> buffers) const;
    double dispatch(uint32_t begin, uint32_t count) const;

    std::shared_ptr<Context> context_;
    std::string file_;
    size_t spirv_bytes_ = 0;
    bool from_cache_ = false;
    uint32_t local_size_ = 64;
    std::vector<ShaderBinding> bindings_;
    std::vector<vk::raii::DescriptorSetLayout> set_layouts_;
    vk::raii::PipelineLayout layout_ = nullptr;
    vk::raii::Pipeline pipeline_ = nullptr;
    vk::raii::DescriptorPool pool_ = nullptr;
    std::vector<vk::raii::DescriptorSet> sets_;
    vk::raii::QueryPool queries_ = nullptr;
    mutable uint32_t chunk_ = 0;       // indices of the next dispatch
    mutable uint32_t dispatches_ = 0;  // so far
};

}  // namespace lampyris::vulkan

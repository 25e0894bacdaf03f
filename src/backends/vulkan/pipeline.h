// A kernel's pipeline for one choice of which buffers are bound and which are accessed by address.
#pragma once

#include "backends/shaders/spirv.h"
#include "backends/vulkan/memory.h"

#include <span>
#include <string>
#include <vector>

namespace lampyris::vulkan {

using shaders::ShaderBinding;
using shaders::Spirv;

constexpr uint32_t kSets = 2;  // of descriptors: the scene's, the kernel's own

// For each of a kernel's bindings, in order, whether it is accessed by address.
using Addressed = std::vector<bool>;

class KernelPipeline {
 public:
    // Throws MachineError if the device cannot bind this many buffers, or pass this many addresses.
    KernelPipeline(std::shared_ptr<Context> context, const std::string& file, const Spirv& spirv,
                   std::span<const ShaderBinding> bindings, const Addressed& addressed, uint32_t local_size);

    // Binds a resource to each of the constructor's bindings.
    void bind(std::span<const KernelBinding> buffers);
    // Runs indices [begin, begin + count) in one dispatch. Returns the seconds on the device.
    double dispatch(uint32_t begin, uint32_t count);

 private:
    std::shared_ptr<Context> context_;
    uint32_t local_size_ = 64;
    std::vector<ShaderBinding> bindings_;
    Addressed addressed_;
    std::vector<vk::DeviceAddress> addresses_;
    std::vector<vk::raii::DescriptorSetLayout> set_layouts_;
    vk::raii::PipelineLayout layout_ = nullptr;
    vk::raii::Pipeline pipeline_ = nullptr;
    vk::raii::DescriptorPool pool_ = nullptr;
    std::vector<vk::raii::DescriptorSet> sets_;
    vk::raii::QueryPool queries_ = nullptr;
};

}  // namespace lampyris::vulkan

// Acceleration structures over boxes that kernels wrote (Device::build_boxes).
#pragma once

#include "backends/vulkan/acceleration_structure.h"

namespace lampyris::vulkan {

// One bottom level of boxes, and one top level whose only instance it is. Memory is reused from build to build.
class BoxStructure {
 public:
    BoxStructure(std::shared_ptr<Context> context, std::shared_ptr<MemoryAccount> account, bool staged)
        : builder_(std::move(context), std::move(account), staged) {}
    // Builds over the first `count` boxes at this address. Returns the bytes of all memory that it holds.
    size_t build(vk::DeviceAddress boxes, uint32_t count);
    vk::AccelerationStructureKHR top_level() const { return *top_.structure; }

 private:
    StructureBuilder builder_;
    AccelerationStructure bottom_, top_;
    vk::DeviceAddress instanced_ = 0;  // the bottom level that the instance refers to
    std::unique_ptr<VulkanBuffer> instance_;
};

}  // namespace lampyris::vulkan

// Building acceleration structures (VK_KHR_acceleration_structure), once or again and again.
#pragma once

#include "backends/vulkan/memory.h"

namespace lampyris::vulkan {

struct AccelerationStructure {
    std::unique_ptr<VulkanBuffer> storage;
    vk::raii::AccelerationStructureKHR structure = nullptr;
    vk::DeviceAddress address = 0;
};

// The usage flags that a buffer must have to be an input of a build.
constexpr vk::BufferUsageFlags kBuildInputUsage = vk::BufferUsageFlagBits::eShaderDeviceAddress |
                                                  vk::BufferUsageFlagBits::eAccelerationStructureBuildInputReadOnlyKHR;

class StructureBuilder {
 public:
    StructureBuilder(std::shared_ptr<Context> context, std::shared_ptr<MemoryAccount> account, bool staged)
        : context_(std::move(context)), account_(std::move(account)), staged_(staged) {}

    // Builds on the device from inputs that earlier submissions wrote. Reuses `into`'s memory and the scratch memory if they
    // suffice. If not, and if `again` says that more builds follow, the new memory has room for slightly larger ones.
    void build(AccelerationStructure& into, vk::AccelerationStructureTypeKHR type,
               const vk::AccelerationStructureGeometryKHR& geometry, uint32_t count, bool again = false);
    std::unique_ptr<VulkanBuffer> input(const void* data, size_t bytes, const char* name) const;
    size_t scratch_bytes() const { return scratch_ ? scratch_->size() : 0; }

 private:
    std::shared_ptr<Context> context_;
    std::shared_ptr<MemoryAccount> account_;
    bool staged_ = false;
    std::unique_ptr<VulkanBuffer> scratch_;
};

// Geometry for a top level's instances, or a bottom level's boxes (six floats each), stored at this address.
vk::AccelerationStructureGeometryKHR instances_at(vk::DeviceAddress address);
vk::AccelerationStructureGeometryKHR boxes_at(vk::DeviceAddress address);

}  // namespace lampyris::vulkan

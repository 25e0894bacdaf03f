// Buffers: mapped where host and device see the same memory, staged otherwise.
#pragma once

#include "backends/vulkan/context.h"

namespace lampyris::vulkan {

class BoxStructure;

// Bytes in use and their peak, the limit (0: none), and the number of buffers that kernels must access by address.
struct MemoryAccount {
    size_t used = 0, peak = 0;
    size_t too_large_to_bind = 0;  // number of buffers
    uint64_t limit = 0;
};

struct BufferOptions {
    bool staged = false;     // device-local memory that the host does not map
    bool read_back = false;  // mapped, and mostly read by the host
    vk::BufferUsageFlags usage = vk::BufferUsageFlagBits::eStorageBuffer;
    size_t alignment = 0;  // of the address; 0: whatever the device wants
};

// The resource of a kernel's binding: a buffer, or the acceleration structure over its boxes, depending on the kernel's
// declaration. A buffer that is too large to be bound has an address.
struct KernelBinding {
    vk::Buffer buffer;
    vk::AccelerationStructureKHR structure;
    vk::DeviceAddress address = 0;
};

class VulkanBuffer final : public Buffer {
 public:
    // Throws MachineError naming the buffer where there is no memory for it.
    VulkanBuffer(std::shared_ptr<Context> context, std::shared_ptr<MemoryAccount> account, size_t bytes,
                 std::string_view name, BufferOptions options);
    ~VulkanBuffer() override;
    VulkanBuffer(const VulkanBuffer&) = delete;
    VulkanBuffer& operator=(const VulkanBuffer&) = delete;

    size_t size() const override { return size_; }
    void upload(const void* data, size_t bytes, size_t offset) override;
    void download(void* data, size_t bytes, size_t offset) const override;
    void fill_zero() override;

    vk::Buffer handle() const { return *buffer_; }
    vk::DeviceAddress address() const;  // for buffers with eShaderDeviceAddress, and those that are too large to bind
    KernelBinding binding() const;
    void* mapped() const { return mapped_; }
    void check_range(size_t bytes, size_t offset) const;  // throws std::logic_error

    std::shared_ptr<BoxStructure> boxes;  // over the buffer's contents, if these are boxes

 private:
    std::shared_ptr<Context> context_;
    std::shared_ptr<MemoryAccount> account_;
    std::string name_;
    size_t size_ = 0, allocated_ = 0;
    bool too_large_to_bind_ = false;
    vk::raii::DeviceMemory memory_ = nullptr;  // declared before buffer_, so that it is freed after it
    vk::raii::Buffer buffer_ = nullptr;
    void* mapped_ = nullptr;
};

}  // namespace lampyris::vulkan

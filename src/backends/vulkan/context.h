// A Vulkan instance, a device chosen from it, one queue; and the reporting of errors.
#pragma once

#include "backends/vulkan/validation.h"
#include "backends/vulkan/vulkan.h"
#include "core/device/device.h"

#include <memory>
#include <string>
#include <vector>

namespace lampyris::vulkan {

// The chosen device's capabilities, as far as Lampyris uses them.
struct Capabilities {
    bool is_cpu = false, is_integrated = false;
    bool ray_query = false;
    uint64_t max_boxes = 0;  // in an acceleration structure
    bool int64 = false, int64_atomics = false;
    bool flushes_denormals = false;  // of floats, if requested
    bool ends_loops = false;         // after 65,535 iterations, counting those of nested loops
    bool timestamps = false;
    double timestamp_ns = 1;  // per tick
    // Limits of a bound buffer, of an allocation, and of a dispatch's push constants.
    uint64_t max_storage_range = 0, max_allocation = 0, max_push_constants = 0;
    bool buffer_addresses = false;  // and 64-bit integers to compute them with
    uint32_t max_storage_buffers = 0, max_groups = 0;
    bool has_host_visible_local = false;  // device-local memory that the host can map, so that nothing need be copied
};

// The Vulkan library and a connection to it.
struct Connection {
    vk::raii::Context loader;
    vk::raii::Instance instance = nullptr;
};

// Host-mapped memory, for copies to and from memory that the host cannot map.
struct Staging {
    vk::raii::DeviceMemory memory = nullptr;
    vk::raii::Buffer buffer = nullptr;
    void* mapped = nullptr;
    size_t size = 0;
};

class Context {
 public:
    // Throws MachineError where there is no Vulkan or no such device.
    explicit Context(const DeviceOptions& options);

    ValidationLog validation_log;  // before the instance, which writes to it until it is gone
    std::shared_ptr<const Connection> connection;
    vk::raii::DebugUtilsMessengerEXT messenger = nullptr;
    vk::raii::PhysicalDevice physical = nullptr;
    vk::raii::Device device = nullptr;
    vk::raii::Queue queue = nullptr;
    vk::raii::CommandPool command_pool = nullptr;
    uint32_t queue_family = 0;
    Capabilities can;
    std::string name, driver;
    bool validation = false;

    // The index of a memory type of `allowed` that has all of `wanted`, and preferably `liked`; throws MachineError if there is
    // none.
    uint32_t memory_type(uint32_t allowed, vk::MemoryPropertyFlags wanted, vk::MemoryPropertyFlags liked = {}) const;
    // Throws MachineError with the messages of the validation layers since the last call, if there are any.
    void check_validation();
    // Calls `record` to record commands, submits them, and waits.
    template <typename Record>
    void submit(Record&& record) {
        vk::raii::CommandBuffers buffers(device, {*command_pool, vk::CommandBufferLevel::ePrimary, 1});
        buffers[0].begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        record(buffers[0]);
        buffers[0].end();
        submit_and_wait(*buffers[0]);
    }
    void submit_and_wait(vk::CommandBuffer commands);
    // A staging buffer of at least this size, which the next copy reuses. Throws vk::Error.
    enum class Direction { upload, download };
    Staging& staging(Direction direction, size_t bytes);

 private:
    vk::raii::Fence fence_ = nullptr;
    Staging staging_[2];
};

// Every Vulkan device of this machine, in the order of the numbers that --device takes: GPUs before CPUs.
std::vector<DeviceInfo> list_vulkan_devices();

// A vk::Error as text for people: what it means and what may help.
std::string explain(const vk::Error& error, const std::string& doing);

}  // namespace lampyris::vulkan

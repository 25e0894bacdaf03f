#include "backends/vulkan/context.h"

#include "core/base/error.h"
#include "core/device/device_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstring>

namespace lampyris::vulkan {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";
constexpr uint32_t kApiVersion = VK_API_VERSION_1_2;

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* log) {
    static_cast<ValidationLog*>(log)->add(data->pMessage ? data->pMessage : "(no text)");
    return VK_FALSE;
}

vk::DebugUtilsMessengerCreateInfoEXT messenger_info(ValidationLog& log) {
    using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
    using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
    return {{}, Severity::eWarning | Severity::eError, Type::eValidation | Type::ePerformance, &on_message, &log};
}

vk::raii::Instance make_instance(const vk::raii::Context& loader, ValidationLog* log) {
    const vk::ApplicationInfo application("lampyris", 1, "lampyris", 1, kApiVersion);
    std::vector<const char*> layers, extensions;
    if (log) {
        const auto available = loader.enumerateInstanceLayerProperties();
        const bool found = std::any_of(available.begin(), available.end(), [](const auto& layer) {
            return std::strcmp(layer.layerName, kValidationLayer) == 0;
        });
        if (!found)
            throw MachineError(fmt::format(
                "error: backend.validation=on: the layer {} is not installed (Debian: vulkan-validationlayers)",
                kValidationLayer));
        layers.push_back(kValidationLayer);
        extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    }
    vk::InstanceCreateInfo info({}, &application, layers, extensions);
    vk::DebugUtilsMessengerCreateInfoEXT messages;
    const vk::ValidationFeatureEnableEXT enabled[] = {vk::ValidationFeatureEnableEXT::eSynchronizationValidation};
    vk::ValidationFeaturesEXT features(enabled);
    if (log) {
        messages = messenger_info(*log);
        info.setPNext(&messages);
        messages.setPNext(&features);
    }
    return {loader, info};
}

std::shared_ptr<const Connection> connect(ValidationLog* log) {
    auto connection = std::make_shared<Connection>();
    connection->instance = make_instance(connection->loader, log);
    return connection;
}

// One for the whole program, never destroyed: NVIDIA's driver (580) fails after some twenty instances were created and
// destroyed.
std::shared_ptr<const Connection> shared_connection() {
    static const auto* const kept = new std::shared_ptr<const Connection>(connect(nullptr));
    return *kept;
}

int preference(vk::PhysicalDeviceType type) {
    switch (type) {
        case vk::PhysicalDeviceType::eDiscreteGpu: return 0;
        case vk::PhysicalDeviceType::eIntegratedGpu: return 1;
        case vk::PhysicalDeviceType::eVirtualGpu: return 2;
        case vk::PhysicalDeviceType::eCpu: return 3;
        default: return 4;
    }
}

// Devices in the order of their numbers: the fastest kind first.
std::vector<vk::raii::PhysicalDevice> devices_of(const vk::raii::Instance& instance) {
    vk::raii::PhysicalDevices all(instance);
    std::vector<vk::raii::PhysicalDevice> devices(std::make_move_iterator(all.begin()),
                                                  std::make_move_iterator(all.end()));
    std::erase_if(devices, [](const auto& device) { return device.getProperties().apiVersion < kApiVersion; });
    std::stable_sort(devices.begin(), devices.end(), [](const auto& a, const auto& b) {
        return preference(a.getProperties().deviceType) < preference(b.getProperties().deviceType);
    });
    return devices;
}

bool has_extension(const vk::raii::PhysicalDevice& device, const char* name) {
    const auto extensions = device.enumerateDeviceExtensionProperties();
    return std::any_of(extensions.begin(), extensions.end(),
                       [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

bool offers_ray_query(const vk::raii::PhysicalDevice& device) {
    if (!has_extension(device, VK_KHR_RAY_QUERY_EXTENSION_NAME) ||
        !has_extension(device, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME) ||
        !has_extension(device, VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME)) {
        return false;
    }
    const auto features =
        device.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceRayQueryFeaturesKHR,
                            vk::PhysicalDeviceAccelerationStructureFeaturesKHR, vk::PhysicalDeviceVulkan12Features>();
    return features.get<vk::PhysicalDeviceRayQueryFeaturesKHR>().rayQuery &&
           features.get<vk::PhysicalDeviceAccelerationStructureFeaturesKHR>().accelerationStructure &&
           features.get<vk::PhysicalDeviceVulkan12Features>().bufferDeviceAddress;
}

bool offers_int64_atomics(const vk::raii::PhysicalDevice& device) {
    return device.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features>()
        .get<vk::PhysicalDeviceVulkan12Features>()
        .shaderBufferInt64Atomics;
}

// Mesa's llvmpipe did before version 25. The version is only available as text.
bool ends_loops(const vk::raii::PhysicalDevice& device) {
    const auto properties = device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>();
    const auto& driver = properties.get<vk::PhysicalDeviceDriverProperties>();
    if (driver.driverID != vk::DriverId::eMesaLlvmpipe) return false;
    constexpr unsigned kFirstWithout = 25;
    unsigned version = 0;
    return std::sscanf(driver.driverInfo.data(), "Mesa %u", &version) != 1 || version < kFirstWithout;
}

bool offers_buffer_addresses(const vk::raii::PhysicalDevice& device) {
    return device.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features>()
        .get<vk::PhysicalDeviceVulkan12Features>()
        .bufferDeviceAddress;
}

std::string driver_of(const vk::raii::PhysicalDevice& device) {
    const auto properties = device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>();
    const auto& driver = properties.get<vk::PhysicalDeviceDriverProperties>();
    return fmt::format("{} {}", driver.driverName.data(), driver.driverInfo.data());
}

uint64_t local_memory(const vk::raii::PhysicalDevice& device) {
    uint64_t bytes = 0;
    const auto memory = device.getMemoryProperties();
    for (uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
        if (memory.memoryHeaps[i].flags & vk::MemoryHeapFlagBits::eDeviceLocal) bytes += memory.memoryHeaps[i].size;
    }
    return bytes;
}

Capabilities capabilities_of(const vk::raii::PhysicalDevice& device, uint32_t queue_family) {
    const auto properties =
        device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceMaintenance3Properties>();
    const auto& base = properties.get<vk::PhysicalDeviceProperties2>().properties;
    Capabilities can;
    can.is_cpu = base.deviceType == vk::PhysicalDeviceType::eCpu;
    can.is_integrated = base.deviceType == vk::PhysicalDeviceType::eIntegratedGpu;
    can.ray_query = offers_ray_query(device);
    if (can.ray_query)
        can.max_boxes =
            device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceAccelerationStructurePropertiesKHR>()
                .get<vk::PhysicalDeviceAccelerationStructurePropertiesKHR>()
                .maxPrimitiveCount;
    can.int64 = device.getFeatures().shaderInt64;
    can.int64_atomics = can.int64 && offers_int64_atomics(device);
    can.buffer_addresses = can.int64 && offers_buffer_addresses(device);
    can.flushes_denormals =
        device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceFloatControlsProperties>()
            .get<vk::PhysicalDeviceFloatControlsProperties>()
            .shaderDenormFlushToZeroFloat32;
    can.ends_loops = ends_loops(device);
    can.timestamps =
        device.getQueueFamilyProperties()[queue_family].timestampValidBits > 0 && base.limits.timestampPeriod > 0;
    can.timestamp_ns = base.limits.timestampPeriod;
    can.max_storage_range = base.limits.maxStorageBufferRange;
    can.max_push_constants = base.limits.maxPushConstantsSize;
    can.max_storage_buffers = base.limits.maxPerStageDescriptorStorageBuffers;
    can.max_groups = base.limits.maxComputeWorkGroupCount[0];
    can.max_allocation = properties.get<vk::PhysicalDeviceMaintenance3Properties>().maxMemoryAllocationSize;
    using Memory = vk::MemoryPropertyFlagBits;
    constexpr auto kBoth = Memory::eDeviceLocal | Memory::eHostVisible | Memory::eHostCoherent;
    const auto memory = device.getMemoryProperties();
    for (uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
        if ((memory.memoryTypes[i].propertyFlags & kBoth) == kBoth)
            can.has_host_visible_local = can.is_cpu || can.is_integrated;
    }
    return can;
}

size_t choose(const std::vector<vk::raii::PhysicalDevice>& devices, const std::string& wish) {
    std::vector<std::string> names;
    for (const vk::raii::PhysicalDevice& device : devices) names.emplace_back(device.getProperties().deviceName.data());
    return choose_device(names, wish, "Vulkan");
}

}  // namespace

std::string explain(const vk::Error& error, const std::string& doing) {
    const auto* system = dynamic_cast<const vk::SystemError*>(&error);
    const auto code = system ? static_cast<vk::Result>(system->code().value()) : vk::Result::eErrorUnknown;
    const char* help = "";
    switch (code) {
        case vk::Result::eErrorDeviceLost:
            help =
                ": the device was lost (its driver crashed, or a kernel ran too long); --backend cpu does without it";
            break;
        case vk::Result::eErrorOutOfHostMemory: help = ": the machine has no memory left"; break;
        case vk::Result::eErrorOutOfDeviceMemory:
            help =
                ": the device has no memory left; a smaller --resolution or fewer photons per pass need less, and "
                "--backend cpu uses the machine's";
            break;
        case vk::Result::eErrorIncompatibleDriver:
            help = ": no Vulkan driver is installed (Debian: mesa-vulkan-drivers)";
            break;
        default: break;
    }
    return fmt::format("error: Vulkan: {} failed{} ({})", doing, help, error.what());
}

void ValidationLog::add(std::string message) {
    const std::lock_guard lock(mutex_);
    messages_.push_back(std::move(message));
}
std::vector<std::string> ValidationLog::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(messages_, {});
}
bool ValidationLog::empty() const {
    const std::lock_guard lock(mutex_);
    return messages_.empty();
}

Context::Context(const DeviceOptions& options) try {
    validation = read_switch(options, "validation", Switch::off) == Switch::on;
    connection = validation ? connect(&validation_log) : shared_connection();
    if (validation) messenger = vk::raii::DebugUtilsMessengerEXT(connection->instance, messenger_info(validation_log));
    auto devices = devices_of(connection->instance);
    if (devices.empty())
        throw MachineError(
            "error: there is no Vulkan 1.2 device (Debian: mesa-vulkan-drivers has one that needs no GPU); --backend "
            "cpu needs none");
    physical = std::move(devices[choose(devices, options.device)]);
    const auto families = physical.getQueueFamilyProperties();
    const auto family = std::find_if(families.begin(), families.end(),
                                     [](const auto& f) { return bool(f.queueFlags & vk::QueueFlagBits::eCompute); });
    if (family == families.end()) throw MachineError("error: the Vulkan device has no compute queue");
    queue_family = static_cast<uint32_t>(family - families.begin());
    can = capabilities_of(physical, queue_family);
    name = physical.getProperties().deviceName.data();
    driver = driver_of(physical);

    const float priority = 1;
    const vk::DeviceQueueCreateInfo queues({}, queue_family, 1, &priority);
    std::vector<const char*> extensions;
    if (can.ray_query) {
        extensions = {VK_KHR_RAY_QUERY_EXTENSION_NAME, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                      VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME};
    }
    vk::StructureChain<vk::DeviceCreateInfo, vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features,
                       vk::PhysicalDeviceAccelerationStructureFeaturesKHR, vk::PhysicalDeviceRayQueryFeaturesKHR>
        chain;
    chain.get<vk::DeviceCreateInfo>().setQueueCreateInfos(queues).setPEnabledExtensionNames(extensions);
    chain.get<vk::PhysicalDeviceFeatures2>().features.shaderInt64 = can.int64;
    chain.get<vk::PhysicalDeviceVulkan12Features>().shaderBufferInt64Atomics = can.int64_atomics;
    chain.get<vk::PhysicalDeviceVulkan12Features>().bufferDeviceAddress = can.buffer_addresses || can.ray_query;
    if (can.ray_query) {
        chain.get<vk::PhysicalDeviceAccelerationStructureFeaturesKHR>().accelerationStructure = true;
        chain.get<vk::PhysicalDeviceRayQueryFeaturesKHR>().rayQuery = true;
    } else {
        chain.unlink<vk::PhysicalDeviceAccelerationStructureFeaturesKHR>();
        chain.unlink<vk::PhysicalDeviceRayQueryFeaturesKHR>();
    }
    device = vk::raii::Device(physical, chain.get<vk::DeviceCreateInfo>());
    queue = vk::raii::Queue(device, queue_family, 0);
    command_pool = vk::raii::CommandPool(
        device,
        {vk::CommandPoolCreateFlagBits::eResetCommandBuffer | vk::CommandPoolCreateFlagBits::eTransient, queue_family});
    fence_ = vk::raii::Fence(device, vk::FenceCreateInfo());
} catch (const vk::Error& error) {
    throw MachineError(explain(error, "opening a device"));
}

uint32_t Context::memory_type(uint32_t allowed, vk::MemoryPropertyFlags wanted, vk::MemoryPropertyFlags liked) const {
    const auto memory = physical.getMemoryProperties();
    for (const auto flags : {wanted | liked, wanted}) {
        for (uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
            if ((allowed >> i & 1u) && (memory.memoryTypes[i].propertyFlags & flags) == flags) return i;
        }
    }
    throw MachineError(fmt::format("error: Vulkan: {} has no memory that is {}", name, vk::to_string(wanted)));
}

void Context::check_validation() {
    if (validation_log.empty()) return;
    std::string text = "error: the Vulkan validation layers complain:";
    for (const std::string& message : validation_log.take()) text += "\n  " + message;
    throw MachineError(text);
}

void Context::submit_and_wait(vk::CommandBuffer commands) {
    device.resetFences(*fence_);
    queue.submit(vk::SubmitInfo({}, {}, commands), *fence_);
    if (device.waitForFences(*fence_, true, UINT64_MAX) != vk::Result::eSuccess)
        throw MachineError("error: Vulkan: waiting for the device failed");
}

Staging& Context::staging(Direction direction, size_t bytes) {
    Staging& kept = staging_[direction == Direction::download];
    if (kept.size >= bytes) return kept;
    kept = {};
    const size_t size = std::bit_ceil(std::max<size_t>(bytes, 1 << 16));
    using Memory = vk::MemoryPropertyFlagBits;
    const bool read = direction == Direction::download;
    Staging made;
    made.buffer =
        vk::raii::Buffer(device, {{},
                                  size,
                                  read ? vk::BufferUsageFlagBits::eTransferDst : vk::BufferUsageFlagBits::eTransferSrc,
                                  vk::SharingMode::eExclusive});
    const auto needs = made.buffer.getMemoryRequirements();
    // Reading uncached memory is hundreds of times slower: word by word, over the bus.
    const uint32_t type = memory_type(needs.memoryTypeBits, Memory::eHostVisible | Memory::eHostCoherent,
                                      read ? Memory::eHostCached : vk::MemoryPropertyFlags());
    made.memory = vk::raii::DeviceMemory(device, vk::MemoryAllocateInfo(needs.size, type));
    made.buffer.bindMemory(*made.memory, 0);
    made.mapped = made.memory.mapMemory(0, VK_WHOLE_SIZE);
    made.size = size;
    kept = std::move(made);
    return kept;
}

std::vector<DeviceInfo> list_vulkan_devices() try {
    const auto connection = shared_connection();
    std::vector<DeviceInfo> list;
    for (const auto& device : devices_of(connection->instance)) {
        const auto properties = device.getProperties();
        DeviceInfo info;
        info.backend = "vulkan";
        info.index = static_cast<int>(list.size());
        info.name = properties.deviceName.data();
        info.driver = driver_of(device);
        info.memory_bytes = local_memory(device);
        const auto can = capabilities_of(device, 0);
        info.features["type"] = vk::to_string(properties.deviceType);
        info.features["vulkan"] =
            fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(properties.apiVersion),
                        VK_API_VERSION_MINOR(properties.apiVersion), VK_API_VERSION_PATCH(properties.apiVersion));
        info.features["ray_query"] = can.ray_query ? "yes" : "no";
        info.features["int64_atomics"] = can.int64_atomics ? "yes" : "no";
        info.features["host_visible"] = can.has_host_visible_local ? "yes" : "no";
        list.push_back(std::move(info));
    }
    return list;
} catch (const vk::Error&) {
    return {};  // no Vulkan on this machine: no devices
}

}  // namespace lampyris::vulkan

// A device owns buffers, runs kernels and traces rays. Integrators and tests talk to this interface only: the host schedule
// is as shared as the kernels are.
#pragma once

#include "core/error.h"
#include "core/kernel_registry.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

struct Scene;

// Memory that kernels see. Host and device meet through upload and download; on devices whose memory the host sees, both
// are plain copies.
class Buffer {
 public:
    virtual ~Buffer() = default;
    virtual size_t size() const = 0;  // bytes
    virtual void upload(const void* data, size_t bytes, size_t offset = 0) = 0;
    virtual void download(void* data, size_t bytes, size_t offset = 0) const = 0;
    virtual void fill_zero() = 0;
};
using BufferHandle = std::shared_ptr<Buffer>;

// A scene's buffers and acceleration structures on a device.
class DeviceScene {
 public:
    virtual ~DeviceScene() = default;
};
using DeviceSceneHandle = std::shared_ptr<DeviceScene>;

// A buffer, and the name that a kernel knows it by (BUFFER_RO, BUFFER_RW).
struct NamedBuffer {
    std::string_view name;  // outlives the call: a literal, as a rule
    BufferHandle buffer;
};

// A kernel file with a set of effects, ready to run on a device (compiled, for Vulkan).
class Kernel {
 public:
    // `found`: the buffers that the device itself knows of; they are taken where the kernel has no C++ build, which knows all.
    Kernel(std::string_view file, std::vector<KernelBuffer> found = {});
    virtual ~Kernel() = default;
    const std::string& file() const { return file_; }
    const std::vector<KernelBuffer>& buffers() const { return buffers_; }
    bool declares(std::string_view buffer) const;
    // What is given, in the order of bindings. Throws std::logic_error where a buffer is missing, unknown or given twice, or has no room
    // for an element.
    std::vector<BufferHandle> bind(std::span<const NamedBuffer> given) const;

 private:
    std::string file_;
    std::vector<KernelBuffer> buffers_;
    bool all_known_;
};
using KernelHandle = std::shared_ptr<Kernel>;

struct DeviceStatistics {
    double build_s = 0;    // acceleration structures
    double compile_s = 0;  // shaders
    size_t memory_bytes = 0, peak_memory_bytes = 0;
    std::map<std::string, double> kernel_s;  // seconds in each kernel, by its file's name, and in build_boxes
    std::map<std::string, size_t>
        spirv_bytes;  // size of each kernel's SPIR-V, by its file's name; empty on CPU backends
};

// A kernel could not do all of its work: a loop's bound or a stack was not enough, or the driver ended a loop early. Less work at
// once may do.
class UnfinishedError : public MachineError {
 public:
    using MachineError::MachineError;
};

// What not every device can do.
enum class DeviceFeature {
    kInt64Atomics,
    kRayQuery,   // rays of a scene are traced by hardware, or by what the driver has in its place
    kBoxes,      // build_boxes
    kLongLoops,  // loops of any length in a kernel; elsewhere the driver ends them, and run throws UnfinishedError
};

class Device {
 public:
    virtual ~Device() = default;
    virtual std::string backend() const = 0;      // "cpu", "cpu-bvh2", "vulkan"
    virtual std::string description() const = 0;  // processor or device, driver
    virtual unsigned threads() const = 0;         // 0 where it has no meaning
    virtual bool offers(DeviceFeature feature) const = 0;

    // Throws MachineError where there is no memory for it.
    virtual BufferHandle create_buffer(size_t bytes, std::string_view name) = 0;

    // Builds acceleration structures and uploads the scene. The scene must outlive the result.
    virtual DeviceSceneHandle upload(const Scene& scene) = 0;

    // `file` is the kernel's path below its source root ("integrators/path/path.radiance.h"), or several joined by '+', which
    // make one kernel in that order ("accel/collect/collect.consumer.h+accel/linked_list/linked_list.gather.h"); code for effects
    // outside `effects` may be left out. A kernel that traces rays or reads the scene needs a DeviceScene to run.
    virtual KernelHandle compile(std::string_view file, uint64_t effects) = 0;

    // Runs the kernel for the indices [begin, begin + count), split as the device needs, with a buffer for each that it declares.
    // Returns when it is done. `scene` may be null for kernels that use no scene buffer. With a count of 0 it gets the kernel ready for
    // these buffers: some devices compile it anew for buffers above a size. Throws MachineError when the device fails, and
    // UnfinishedError when a kernel reports an unfinished loop: what the buffers hold is then indeterminate.
    virtual void run(const Kernel& kernel, const DeviceScene* scene, std::span<const NamedBuffer> buffers,
                     uint32_t begin, uint32_t count) = 0;

    // Builds an acceleration structure over the first `count` boxes of a buffer, six floats each (low x, y, z, high x, y, z). It stays
    // with the buffer until it is built anew; a kernel in which the buffer's binding is an accelerationStructureEXT asks it,
    // by ray query, which boxes a ray meets. Returns the bytes that it takes. Throws MachineError where the device does not
    // offer DeviceFeature::kBoxes.
    virtual size_t build_boxes(const BufferHandle& boxes, uint32_t count);

    virtual DeviceStatistics statistics() const = 0;
};

// Invocations of a kernel that handles BATCH items in each (core/kernel/prelude.h).
constexpr uint32_t batch_count(uint32_t items) {
    constexpr uint32_t kItems = 16 * 32;  // of BATCH times the neighbours on a GPU
    return (items / kItems + (items % kItems != 0)) * 32;
}

struct DeviceOptions {
    std::string device;                           // number or part of the name; empty: the first
    unsigned threads = 0;                         // 0: all
    uint64_t max_memory = 0;                      // bytes; 0: no limit
    std::map<std::string, std::string> settings;  // --set backend.KEY=VALUE
};

struct DeviceInfo {
    std::string backend;
    int index = 0;
    std::string name, driver;
    uint64_t memory_bytes = 0;
    std::map<std::string, std::string> features;
};

// A backend registers itself: how to make its device, and what devices there are.
struct BackendRegistration {
    BackendRegistration(const char* name, const char* summary,
                        std::function<std::unique_ptr<Device>(const DeviceOptions&)> create,
                        std::function<std::vector<DeviceInfo>()> list);
};

// For backends: throws InputError for a setting that is not among those that they have.
void check_settings(const std::string& backend, const DeviceOptions& options, const std::vector<std::string>& known);

// Throws InputError for an unknown backend (with the list), MachineError where it has no device.
std::unique_ptr<Device> create_device(const std::string& backend, const DeviceOptions& options = {});
std::vector<std::string> backend_names();
std::vector<std::pair<std::string, std::string>> backend_summaries();  // name, summary
std::vector<DeviceInfo> list_devices();                                // of every backend

}  // namespace lampyris

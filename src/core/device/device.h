// A device owns buffers, runs kernels and traces rays. Integrators and tests use only this interface: all backends share the
// host's schedule as well as the kernels.
#pragma once

#include "core/base/error.h"
#include "core/device/kernel_registry.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lampyris {

struct Scene;
namespace kernel {
struct CameraRecord;
}

// Memory that kernels access. The host exchanges data with it by upload and download; if the host can access the device's
// memory, both are plain copies.
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
    // Replaces the camera that kernels see from the next run on, by one of the same kind: another resolution or place.
    virtual void set_camera(const kernel::CameraRecord& camera) = 0;
};
using DeviceSceneHandle = std::shared_ptr<DeviceScene>;

// A buffer, and its name in a kernel (BUFFER_RO, BUFFER_RW).
struct NamedBuffer {
    std::string_view name;  // must outlive the call; usually a literal
    BufferHandle buffer;
};

// A kernel file with a set of effects, ready to run on a device (compiled, for Vulkan).
class Kernel {
 public:
    // `found`: the buffers that the device itself found in the kernel. They are used if there is no C++ build, which would list
    // all buffers.
    Kernel(std::string_view file, std::vector<KernelBuffer> found = {});
    virtual ~Kernel() = default;
    const std::string& file() const { return file_; }
    const std::vector<KernelBuffer>& buffers() const { return buffers_; }
    bool declares(std::string_view buffer) const;
    // The given buffers, in the order of bindings. Throws std::logic_error if a buffer is missing, unknown or given twice, or
    // is too small for one element.
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
    struct Invocations {
        uint64_t all = 0, in_vectors = 0;
    };
    std::map<std::string, Invocations> invocations;  // of each kernel; empty but on CPU backends
    std::map<std::string, size_t>
        spirv_bytes;  // size of each kernel's SPIR-V, by its file's name; empty on CPU backends
};

// A kernel could not finish its work: it exceeded a loop's bound or a stack, or the driver ended a loop early. Smaller
// dispatches may succeed.
class UnfinishedError : public MachineError {
 public:
    using MachineError::MachineError;
};

// Features that not every device has.
enum class DeviceFeature {
    kInt64Atomics,
    kRayQuery,   // scene rays are traced by hardware, or by the driver's emulation of it
    kBoxes,      // build_boxes
    kLongLoops,  // kernels may have loops of any length; elsewhere the driver ends them, and run throws UnfinishedError
};

class Device {
 public:
    virtual ~Device() = default;
    virtual std::string backend() const = 0;      // "cpu", "cpu-bvh2", "vulkan"
    virtual std::string description() const = 0;  // processor or device, driver
    virtual unsigned threads() const = 0;         // 0 if it has no meaning
    virtual bool offers(DeviceFeature feature) const = 0;

    // Throws MachineError if there is not enough memory.
    virtual BufferHandle create_buffer(size_t bytes, std::string_view name) = 0;

    // Builds acceleration structures and uploads the scene. The scene must outlive the result.
    virtual DeviceSceneHandle upload(const Scene& scene) = 0;

    // `file` is the kernel's path below its source root ("integrators/path/path.radiance.h"), or several joined by '+', which
    // make one kernel in that order ("accel/photons/collect/collect.consumer.h+accel/photons/linked_list/linked_list.gather.h"); code for effects
    // outside `effects` may be left out. A kernel that traces rays or reads the scene needs a DeviceScene to run.
    virtual KernelHandle compile(std::string_view file, uint64_t effects) = 0;

    // Runs the kernel for the indices [begin, begin + count), split as the device needs, with one buffer for each that the
    // kernel declares. Returns when the kernel has finished. `scene` may be null for kernels that use no scene buffer. A count
    // of 0 only prepares the kernel for these buffers: some devices compile it again for buffers above a size. Throws
    // MachineError if the device fails, and UnfinishedError if a kernel reports an unfinished loop; the buffers' contents are
    // then indeterminate.
    virtual void run(const Kernel& kernel, const DeviceScene* scene, std::span<const NamedBuffer> buffers,
                     uint32_t begin, uint32_t count) = 0;

    // Builds an acceleration structure over the first `count` boxes of a buffer, six floats each (low x, y, z, high x, y, z).
    // It stays with the buffer until it is built again. A kernel that declares the buffer's binding as an
    // accelerationStructureEXT finds the boxes that a ray meets by a ray query. Returns the structure's size in bytes. Throws
    // MachineError if the device does not offer DeviceFeature::kBoxes.
    virtual size_t build_boxes(const BufferHandle& boxes, uint32_t count);

    virtual DeviceStatistics statistics() const = 0;

    // The buffer to which kernels with EFFECT_PATH_LOG write (core/kernel/path_log.h); none by default.
    void set_path_log(BufferHandle log) { path_log_ = std::move(log); }

 protected:
    const BufferHandle& path_log() const { return path_log_; }

 private:
    BufferHandle path_log_;
};

// Number of invocations of a kernel in which each invocation handles BATCH items (core/kernel/prelude.h).
constexpr uint32_t batch_count(uint32_t items) {
    constexpr uint32_t kItems = 16 * 32;  // BATCH times the number of adjacent invocations on a GPU
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

// Registers a backend: how to create its device, and which devices there are.
struct BackendRegistration {
    BackendRegistration(const char* name, const char* summary,
                        std::function<std::unique_ptr<Device>(const DeviceOptions&)> create,
                        std::function<std::vector<DeviceInfo>()> list);
};

// For backends: throws InputError for a setting that is not in `known`.
void check_settings(const std::string& backend, const DeviceOptions& options, const std::vector<std::string>& known);

// An on/off/auto setting of `--set backend.KEY=VALUE`; throws InputError for anything else.
enum class Switch { off, on, automatic };
Switch read_switch(const DeviceOptions& options, const std::string& key, Switch otherwise);

// Where compiled kernels are kept: `--set backend.cache=FOLDER`; empty for `off`. Otherwise $XDG_CACHE_HOME/lampyris, or
// ~/.cache/lampyris; empty if neither is known.
std::filesystem::path read_cache_folder(const DeviceOptions& options);

// Throws InputError for an unknown backend (with the list), MachineError if the backend has no device.
std::unique_ptr<Device> create_device(const std::string& backend, const DeviceOptions& options = {});
std::vector<std::string> backend_names();
std::vector<std::pair<std::string, std::string>> backend_summaries();  // name, summary
std::vector<DeviceInfo> list_devices();                                // of every backend

}  // namespace lampyris

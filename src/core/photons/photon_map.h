// A photon map finds the photons within a radius of a query point. It is a plugin of its own, usable by any integrator and by
// the benchmark: build() takes the photons; gather() takes query points, and passes the photons it finds to a consumer.
//     class SortedGrid : public PhotonMap { public: SortedGridParams params; ... };
//     REGISTER_PHOTON_MAP(SortedGrid, SORTED_GRID_PARAMS, "sorted_grid", "A hash grid, its photons sorted by cell.")
// docs/photon-map-guide.md explains how to write one.
#pragma once

#include "core/base/parameters.h"
#include "core/base/registry.h"
#include "core/device/device.h"
#include "core/device/kernel_types.h"

#include <glm/vec3.hpp>

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lampyris {

struct PhotonMapCapabilities {
    bool exact = false;          // finds every photon in range, once, with weight 1
    bool stochastic = false;     // finds a random subset of them, weighted so that sums are right in expectation
    bool lossy = false;          // drops photons if memory does not suffice, and weights the others up: biased
    bool fixed_order = false;    // passes photons on in an order that depends only on the photons and the seed
    bool needs_queries = false;  // build() reads the queries: the structure is built over query points
    bool sums_only = false;      // passes sums on, not photons: gather_value and gather_sums (core/kernel/gather.h)
    // Stops early if a consumer wants only the nearest photons (core/kernel/gather.h: GATHER_SHRINKS).
    bool k_nearest = false;
    bool int64_atomics = false, boxes = false;  // device features that it needs (DeviceFeature)
};

// What a map is built from.
struct PhotonSet {
    BufferHandle photons;  // kernel::PhotonRecord[count], in any order; their keys are unique
    uint32_t count = 0;
    BufferHandle queries;  // vec4[query_count]: position, radius; only if needs_queries; gather() must get the same
    uint32_t query_count = 0;
    float radius = 0;                 // of the largest query
    glm::vec3 low{0.0f}, high{0.0f};  // bounding box of the photons; a wrong one costs time, but loses no photons
    uint32_t seed = 0, pass = 0;      // all random choices of the map are functions of these two
    float mean_power = 0;             // of a photon, as the mean of the channels (approximate; for selection by flux)
};

// The code that receives the photons found by queries.
struct PhotonConsumer {
    std::string file;                    // "accel/photons/collect/collect.consumer.h"; see core/kernel/gather.h
    uint64_t effects = 0;                // of the scene
    const DeviceScene* scene = nullptr;  // if the consumer reads it
    std::vector<NamedBuffer> buffers;    // that the consumer declares
};

struct PhotonMapStatistics {
    // Seconds so far: wall-clock time, and the time within kernels (by timestamps on Vulkan).
    double construction_s = 0, gathering_s = 0;
    double construction_kernel_s = 0, gathering_kernel_s = 0;
    uint64_t lost_photons = 0;  // by lossy maps, so far
};

// Memory traffic per point (photon, or query for maps over queries) that building cannot avoid, in units whose cost `lampyris
// bench photon-maps` measures, too.
struct ConstructionTraffic {
    double accesses = 0;     // reads or writes of a cache line at a random address
    double atomics = 0;      // at random addresses
    double sorted_bits = 0;  // of keys that are radix-sorted
    bool one_thread = false;
};

// Number of invocations of a kernel in which each invocation handles SPAN batches (core/kernel/span.h).
constexpr uint32_t span_count(uint32_t items) {
    constexpr uint32_t kSpan = 4;  // SPAN: must divide 32, because batch_count() is a multiple of 32
    return batch_count(items) / kSpan;
}

struct BucketLoad {
    double mean = 0;  // photons per non-empty bucket
    uint32_t max = 0;
};

class PhotonMap {
 public:
    virtual ~PhotonMap() = default;
    virtual PhotonMapCapabilities capabilities() const = 0;  // with the current parameters
    virtual void* parameters() = 0;                          // the struct that `fields` of its registration describe

    // Compile the kernels of construction, and the gather kernels of a consumer, so that later timings do not include it. Throw
    // InputError for parameters that exclude each other, MachineError if the device lacks a feature.
    void open(Device& device);
    void prepare(const PhotonConsumer& consumer);

    // Buffers are kept for the next build, and grow as needed. The photons' buffer must stay alive, unchanged, until the last
    // gather.
    void build(const PhotonSet& photons);
    // For the queries [first, first + count): position, radius (at most the set's, for speed; any is right, but where the map
    // needs_queries).
    void gather(const PhotonConsumer& consumer, const BufferHandle& queries, uint32_t first, uint32_t count);

    PhotonMapStatistics statistics() const { return statistics_; }
    // The memory traffic that building cannot avoid; all 0 if building only reads the photons.
    virtual ConstructionTraffic traffic() const { return {}; }
    // Of the last build. It is read back from the device, so not to be called in every pass. Empty for maps without buckets.
    virtual std::optional<BucketLoad> bucket_load() const { return std::nullopt; }
    size_t memory_bytes() const;  // of the current buffers, without the photons

 protected:
    virtual std::string name() const = 0;  // also that of its folder and gather file
    virtual void check() const {}          // throws InputError
    virtual void construct(const PhotonSet& photons) = 0;
    virtual std::vector<std::string> kernels() const = 0;  // of construction, to be compiled
    // The map's files that form gather kernels with the consumer.
    virtual std::vector<std::string> gather_files() const { return {name() + ".gather.h"}; }
    // Runs these kernels: by default the first one, over queries.
    virtual void run_gather(std::span<const Kernel* const> kernels, const PhotonConsumer& consumer,
                            const BufferHandle& queries, uint32_t first, uint32_t count);
    void run_gather_kernel(const Kernel& kernel, const PhotonConsumer& consumer, const BufferHandle& queries,
                           uint32_t first, uint32_t count);

    Device& device() const { return *device_; }
    // Runs a kernel of construction, given as a file below the source root. Each buffer that the kernel declares is the one of
    // that name in `others`, or else the kept buffer of that name (`photons`: those of the set). The same rule holds for gather
    // kernels, which also have `queries` and the consumer's buffers.
    void run(const std::string& file, uint32_t count, std::initializer_list<NamedBuffer> others = {});
    // The same, but the invocations run one after the other.
    void run_serially(const std::string& file, uint32_t count);
    // A buffer of at least this size, kept between builds under its name in kernels. Its contents are indeterminate.
    const BufferHandle& keep(const std::string& name, size_t bytes);
    const BufferHandle& kept(const std::string& name) const { return buffers_.at(name); }
    void clear(const BufferHandle& buffer, size_t bytes);  // sets it to zero, on the device
    // Replaces each of `count` words by the sum of those before it.
    void scan(const BufferHandle& values, uint32_t count);
    // Device::build_boxes; the structure's size counts as the map's memory.
    void build_boxes(const BufferHandle& boxes, uint32_t count) {
        structure_bytes_ = device().build_boxes(boxes, count);
    }
    // Sorts `count` pairs of words (key, value) by the lowest `bits` bits of the key, stably. `other` is a second buffer of the
    // same size; returns the one of the two that holds the result. Maps that use it must list kRadixKernels in kernels().
    BufferHandle radix_sort(const BufferHandle& pairs, const BufferHandle& other, uint32_t count, uint32_t bits);
    static const std::vector<std::string> kRadixKernels;
    template <typename T>
    BufferHandle upload(const std::string& name, const T& value) {
        const BufferHandle& buffer = keep(name, sizeof(T));
        buffer->upload(&value, sizeof(T));
        return buffer;
    }
    PhotonMapStatistics statistics_;
    PhotonSet photons_;  // of the last build

 private:
    void scan_level(const BufferHandle& values, uint32_t count, int level);
    std::vector<NamedBuffer> named_buffers(const Kernel& kernel, std::span<const NamedBuffer> others) const;
    std::vector<const Kernel*> gather_kernels(const PhotonConsumer& consumer);
    const Kernel& compiled(const std::string& file, uint64_t effects);
    double kernel_seconds() const;
    Device* device_ = nullptr;
    std::map<std::pair<std::string, uint32_t>, KernelHandle> kernels_;
    std::map<std::string, BufferHandle> buffers_;
    size_t structure_bytes_ = 0;
};

struct PhotonMapFactory {
    std::unique_ptr<PhotonMap> (*create)() = nullptr;
    ParameterFields fields;
};

Registry<PhotonMapFactory>& photon_maps();
// The map that integrators use by default.
inline constexpr const char* kDefaultPhotonMap = "sorted_grid";

// Creates the map that "name:key=value,..." describes. Throws InputError.
std::unique_ptr<PhotonMap> create_photon_map(std::string_view choice);
// The map's current parameters, as text.
std::vector<std::pair<std::string, std::string>> show_photon_map(std::string_view name, PhotonMap& map);

// Photons made on the host, for tests and benchmarks: core/kernel/photon.h compiled as C++.
kernel::PhotonRecord make_photon(glm::vec3 position, glm::vec3 direction, glm::vec3 power, uint32_t key);
glm::vec3 direction_of(const kernel::PhotonRecord& photon);

template <typename Class>
class RegisteredPhotonMap final : public Class {
 public:
    explicit RegisteredPhotonMap(const char* name) : name_(name) {}
    void* parameters() override { return &this->params; }

 protected:
    std::string name() const override { return name_; }

 private:
    std::string name_;
};

struct PhotonMapRegistration {
    PhotonMapRegistration(const char* name, const char* summary, PhotonMapFactory factory);
};

#define REGISTER_PHOTON_MAP(Class, LIST, name, summary)                                                         \
    static const ::lampyris::PhotonMapRegistration registration_of_##Class(                                     \
        name, summary,                                                                                          \
        ::lampyris::PhotonMapFactory{[]() -> std::unique_ptr<::lampyris::PhotonMap> {                           \
                                         return std::make_unique<::lampyris::RegisteredPhotonMap<Class>>(name); \
                                     },                                                                         \
                                     PARAMETER_FIELDS(decltype(Class::params), LIST)});

}  // namespace lampyris

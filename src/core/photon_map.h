// A photon map answers queries for the photons within a radius. It is a plugin of its own, usable by any integrator and by
// the benchmark: build() from photons, then gather() at query points, which hands what was found to a consumer.
//     class SortedGrid : public PhotonMap { public: SortedGridParams params; ... };
//     REGISTER_PHOTON_MAP(SortedGrid, SORTED_GRID_PARAMS, "sorted_grid", "A hash grid, its photons sorted by cell.")
// docs/photon-maps.md tells how to write one.
#pragma once

#include "core/device.h"
#include "core/kernel_types.h"
#include "core/parameters.h"
#include "core/registry.h"

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
    bool stochastic = false;     // finds a random part of them, weighted so that sums are right in expectation
    bool lossy = false;          // drops photons where its memory does not suffice, and weights the others up: biased
    bool fixed_order = false;    // hands photons over in an order that depends on nothing but the photons and the seed
    bool needs_queries = false;  // build() reads the queries: a structure over hit points
    bool sums_only = false;  // hands consumers sums, not photons: gather_value and gather_sums (core/kernel/gather.h)
    // Stops early where a consumer wants the nearest only (core/kernel/gather.h: GATHER_SHRINKS).
    bool k_nearest = false;
    bool int64_atomics = false, boxes = false;  // what it needs of the device (DeviceFeature)
};

// What a map is built from.
struct PhotonSet {
    BufferHandle photons;  // kernel::PhotonRecord[count], in any order; their keys are unique
    uint32_t count = 0;
    BufferHandle queries;  // vec4[query_count]: position, radius; for maps that need them, gather() must use the same
    uint32_t query_count = 0;
    float radius = 0;                 // of the largest query
    glm::vec3 low{0.0f}, high{0.0f};  // box of the photons: a wrong one costs time, not photons
    uint32_t seed = 0, pass = 0;      // what is random about the map is a function of both
    float mean_power = 0;             // of a photon, mean of the channels (roughly; for selection by flux)
};

// Whom the photons that queries find are handed to.
struct PhotonConsumer {
    std::string file;                    // "accel/collect/collect.consumer.h"; see core/kernel/gather.h
    uint64_t effects = 0;                // of the scene
    const DeviceScene* scene = nullptr;  // where the consumer reads it
    std::vector<NamedBuffer> buffers;    // that the consumer declares
};

struct PhotonMapStatistics {
    // Seconds so far, on the wall clock, and of them within kernels (by timestamps on Vulkan).
    double construction_s = 0, gathering_s = 0;
    double construction_kernel_s = 0, gathering_kernel_s = 0;
    uint64_t lost_photons = 0;  // by lossy maps, so far
};

// Memory traffic per point (photon, or query for maps over hit points) that building cannot avoid, in units that
// `lampyris bench photon-maps` measures beside it.
struct ConstructionTraffic {
    double accesses = 0;     // of a cache line at a random place, reading or writing
    double atomics = 0;      // at a random place
    double sorted_bits = 0;  // of keys that are sorted by radix
    bool one_thread = false;
};

// Invocations of a kernel that handles SPAN batches in each (core/kernel/span.h).
constexpr uint32_t span_count(uint32_t items) {
    constexpr uint32_t kSpan = 4;  // SPAN: a divisor of 32, as batch_count() is a multiple
    return batch_count(items) / kSpan;
}

struct BucketLoad {
    double mean = 0;  // photons in a bucket that has any
    uint32_t max = 0;
};

class PhotonMap {
 public:
    virtual ~PhotonMap() = default;
    virtual PhotonMapCapabilities capabilities() const = 0;  // with the parameters as they are
    virtual void* parameters() = 0;                          // the struct that `fields` of its registration describe

    // Compiles what building needs, and the gather kernel for each consumer asked for: so that phases can be timed. Throws
    // InputError for parameters that exclude each other, MachineError where the device cannot.
    void open(Device& device);
    void prepare(const PhotonConsumer& consumer);

    // Buffers are kept for the next build, and grow where it needs more. The photons' buffer must live, unchanged, until
    // the last gather.
    void build(const PhotonSet& photons);
    // For the queries [first, first + count): position, radius (at most the set's, for speed; any is right, but where the map
    // needs_queries).
    void gather(const PhotonConsumer& consumer, const BufferHandle& queries, uint32_t first, uint32_t count);

    PhotonMapStatistics statistics() const { return statistics_; }
    // What building cannot do without; all 0 where that is nothing but reading the photons.
    virtual ConstructionTraffic traffic() const { return {}; }
    // Of the last build; reads it back from the device, so not for every pass. Empty where there are no buckets.
    virtual std::optional<BucketLoad> bucket_load() const { return std::nullopt; }
    size_t memory_bytes() const;  // of buffers now, without the photons

 protected:
    virtual std::string name() const = 0;  // of its folder and its gather file
    virtual void check() const {}          // throws InputError
    virtual void construct(const PhotonSet& photons) = 0;
    virtual std::vector<std::string> kernels() const = 0;  // of construction, to compile
    // The files that make gather kernels with the consumer.
    virtual std::vector<std::string> gather_files() const { return {name() + ".gather.h"}; }
    // Runs these kernels: the first over queries, unless a map does it another way.
    virtual void run_gather(std::span<const Kernel* const> kernels, const PhotonConsumer& consumer,
                            const BufferHandle& queries, uint32_t first, uint32_t count);
    void run_gather_kernel(const Kernel& kernel, const PhotonConsumer& consumer, const BufferHandle& queries,
                           uint32_t first, uint32_t count);

    Device& device() const { return *device_; }
    // Runs a kernel of construction, by its file below the source root. Each buffer that it declares is the one of that name among
    // `others`, or is kept by that name (`photons`: the set's). So it is for gather kernels, which have `queries` and the
    // consumer's besides.
    void run(const std::string& file, uint32_t count, std::initializer_list<NamedBuffer> others = {});
    // The same, one invocation after the other.
    void run_serially(const std::string& file, uint32_t count);
    // A buffer of at least this size, kept between builds by the name that kernels know it by. What it holds is indeterminate.
    const BufferHandle& keep(const std::string& name, size_t bytes);
    const BufferHandle& kept(const std::string& name) const { return buffers_.at(name); }
    void clear(const BufferHandle& buffer, size_t bytes);  // to zero, on the device
    // Replaces each of `count` words by the sum of those before it.
    void scan(const BufferHandle& values, uint32_t count);
    // Device::build_boxes; what it takes counts as the map's memory.
    void build_boxes(const BufferHandle& boxes, uint32_t count) {
        structure_bytes_ = device().build_boxes(boxes, count);
    }
    // Sorts `count` pairs of words (key, value) by the `bits` lowest bits of the key, stably. `other` is room for as many; returns
    // which of both holds the result. Kernels that use it name kRadixKernels among theirs.
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
// What integrators take where nobody says.
inline constexpr const char* kDefaultPhotonMap = "sorted_grid";

// The map that "name:key=value,..." describes. Throws InputError.
std::unique_ptr<PhotonMap> create_photon_map(std::string_view choice);
// Its parameters as they stand, as text.
std::vector<std::pair<std::string, std::string>> show_photon_map(std::string_view name, PhotonMap& map);

// Photons made by the host, for tests and benchmarks: core/kernel/photon.h as C++.
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

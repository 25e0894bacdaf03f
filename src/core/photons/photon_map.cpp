#include "core/photons/photon_map.h"

#include "core/device/cpp_kernel.h"

#include <fmt/format.h>

#include <chrono>

namespace lampyris {
namespace kernel {
namespace {

struct PhotonCode {
#include "core/kernel/photon.h"
};

}  // namespace
}  // namespace kernel

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

constexpr const char* kClear = "core/kernel/clear.kernel.h";
constexpr const char* kScanSum = "core/kernel/scan_sum.kernel.h";
constexpr const char* kScanWrite = "core/kernel/scan_write.kernel.h";

// The number of photons varies from pass to pass: a little more room saves reallocations. A multiple of 16, for clear().
size_t with_room(size_t bytes) { return (bytes + bytes / 8 + 63) / 16 * 16; }

constexpr uint32_t kScanBlock = 1024;  // SCAN_BLOCK of core/kernel/scan.h
constexpr uint32_t kRadixBits = 8, kRadixDigits = 1 << kRadixBits, kRadixBlock = 4096;  // as in core/kernel/radix.h

}  // namespace

kernel::PhotonRecord make_photon(glm::vec3 position, glm::vec3 direction, glm::vec3 power, uint32_t key) {
    return kernel::PhotonCode().photon_pack(position, direction, {power.x, power.y, power.z}, key);
}
glm::vec3 direction_of(const kernel::PhotonRecord& photon) { return kernel::PhotonCode().photon_direction(photon); }

Registry<PhotonMapFactory>& photon_maps() {
    static Registry<PhotonMapFactory> registry(
        "photon-map", "How photons near a point are found: the structure behind progressive photon mapping.");
    return registry;
}

PhotonMapRegistration::PhotonMapRegistration(const char* name, const char* summary, PhotonMapFactory factory) {
    ParameterSpecs specs = specs_of(factory.fields);
    photon_maps().add({name, summary, std::move(specs)}, std::move(factory));
}

std::unique_ptr<PhotonMap> create_photon_map(std::string_view choice) {
    const PluginChoice wanted = parse_plugin_choice(choice);
    const PhotonMapFactory& factory = photon_maps().require(wanted.name);
    std::unique_ptr<PhotonMap> map = factory.create();
    set_defaults(map->parameters(), factory.fields);
    for (const auto& [key, value] : wanted.settings)
        set_parameter(map->parameters(), factory.fields, key, value, fmt::format("photon-map \"{}\"", wanted.name));
    return map;
}

std::vector<std::pair<std::string, std::string>> show_photon_map(std::string_view name, PhotonMap& map) {
    return show_parameters(map.parameters(), photon_maps().require(name).fields);
}

void PhotonMap::open(Device& device) {
    check();
    device_ = &device;
    if (capabilities().int64_atomics && !device.offers(DeviceFeature::kInt64Atomics))
        throw MachineError(fmt::format("error: photon map {} needs 64-bit atomics, which {} does not offer", name(),
                                       device.description()));
    if (capabilities().boxes && !device.offers(DeviceFeature::kBoxes))
        throw MachineError(fmt::format("error: photon map {} is to use VK_KHR_ray_query, which {} does not offer",
                                       name(), device.description()));
    for (const char* file : {kClear, kScanSum, kScanWrite}) compiled(file, 0);
    for (const std::string& file : kernels()) compiled(file, 0);
}

std::vector<const Kernel*> PhotonMap::gather_kernels(const PhotonConsumer& consumer) {
    std::vector<const Kernel*> kernels;
    for (const std::string& file : gather_files()) {
        std::string path = fmt::format("accel/photons/{}/{}", name(), file);
        if (!find_kernel_text(path)) path = fmt::format("{}/{}", name(), file);  // a map outside of this tree
        kernels.push_back(&compiled(fmt::format("{}+{}", consumer.file, path), consumer.effects));
    }
    return kernels;
}

void PhotonMap::prepare(const PhotonConsumer& consumer) { gather_kernels(consumer); }

void PhotonMap::build(const PhotonSet& photons) {
    const auto start = Clock::now();
    const double before = kernel_seconds();
    photons_ = photons;
    construct(photons);
    statistics_.construction_s += seconds_since(start);
    statistics_.construction_kernel_s += kernel_seconds() - before;
}

void PhotonMap::gather(const PhotonConsumer& consumer, const BufferHandle& queries, uint32_t first, uint32_t count) {
    const std::vector<const Kernel*> kernels = gather_kernels(consumer);
    const auto start = Clock::now();
    const double before = kernel_seconds();
    run_gather(kernels, consumer, queries, first, count);
    statistics_.gathering_s += seconds_since(start);
    statistics_.gathering_kernel_s += kernel_seconds() - before;
}

void PhotonMap::run_gather(std::span<const Kernel* const> kernels, const PhotonConsumer& consumer,
                           const BufferHandle& queries, uint32_t first, uint32_t count) {
    run_gather_kernel(*kernels[0], consumer, queries, first, count);
}

void PhotonMap::run_gather_kernel(const Kernel& kernel, const PhotonConsumer& consumer, const BufferHandle& queries,
                                  uint32_t first, uint32_t count) {
    std::vector<NamedBuffer> others = consumer.buffers;
    others.push_back({"queries", queries});
    device().run(kernel, consumer.scene, named_buffers(kernel, others), first, count);
}

std::vector<NamedBuffer> PhotonMap::named_buffers(const Kernel& kernel, std::span<const NamedBuffer> others) const {
    std::vector<NamedBuffer> buffers(others.begin(), others.end());
    for (const KernelBuffer& declared : kernel.buffers()) {
        const auto is_it = [&](const NamedBuffer& buffer) { return buffer.name == declared.name; };
        if (std::any_of(others.begin(), others.end(), is_it)) continue;
        if (declared.name == "photons")
            buffers.push_back({declared.name, photons_.photons});
        else if (const auto found = buffers_.find(declared.name); found != buffers_.end())
            buffers.push_back({declared.name, found->second});
    }
    return buffers;
}

size_t PhotonMap::memory_bytes() const {
    size_t bytes = structure_bytes_;
    for (const auto& [name, buffer] : buffers_) bytes += buffer->size();
    return bytes;
}

void PhotonMap::run(const std::string& file, uint32_t count, std::initializer_list<NamedBuffer> others) {
    const Kernel& kernel = compiled(file, 0);
    device().run(kernel, nullptr, named_buffers(kernel, {others.begin(), others.size()}), 0, count);
}

void PhotonMap::run_serially(const std::string& file, uint32_t count) {
    const Kernel& kernel = compiled(file, 0);
    const std::vector<NamedBuffer> buffers = named_buffers(kernel, {});
    for (uint32_t i = 0; i < count; ++i) device().run(kernel, nullptr, buffers, i, 1);
}

const BufferHandle& PhotonMap::keep(const std::string& name, size_t bytes) {
    BufferHandle& buffer = buffers_[name];
    if (!buffer || buffer->size() < bytes) {
        buffer.reset();  // free the old one before allocating the larger one
        buffer = device().create_buffer(with_room(bytes), fmt::format("photon map: {}", name));
    }
    return buffer;
}

void PhotonMap::clear(const BufferHandle& buffer, size_t bytes) {
    const uint32_t words = uint32_t((bytes + 15) / 16);
    run(kClear, batch_count(words), {{"arguments", upload("clear", glm::uvec4(words, 0, 0, 0))}, {"words", buffer}});
}

void PhotonMap::scan(const BufferHandle& values, uint32_t count) { scan_level(values, count, 0); }

void PhotonMap::scan_level(const BufferHandle& values, uint32_t count, int level) {
    const uint32_t blocks = (count + kScanBlock - 1) / kScanBlock;
    const std::string name = fmt::format("scan {}", level);
    const BufferHandle sums = keep(name, size_t(blocks) * 4);
    const BufferHandle arguments = upload(name + " arguments", glm::uvec4(count, blocks, 0, 0));
    if (blocks > 1) {
        run(kScanSum, blocks, {{"arguments", arguments}, {"values", values}, {"sums", sums}});
        scan_level(sums, blocks, level + 1);
    }
    run(kScanWrite, blocks, {{"arguments", arguments}, {"values", values}, {"sums", sums}});
}

const std::vector<std::string> PhotonMap::kRadixKernels{"core/kernel/radix_count.kernel.h",
                                                        "core/kernel/radix_move.kernel.h"};

BufferHandle PhotonMap::radix_sort(const BufferHandle& pairs, const BufferHandle& other, uint32_t count,
                                   uint32_t bits) {
    BufferHandle from = pairs, to = other;
    const uint32_t blocks = (count + kRadixBlock - 1) / kRadixBlock;
    const BufferHandle counts = keep("radix counts", size_t(blocks) * kRadixDigits * 4);
    for (uint32_t shift = 0; shift < bits; shift += kRadixBits) {
        const BufferHandle arguments = upload("radix", glm::uvec4(count, blocks, shift, 0));
        run(kRadixKernels[0], blocks, {{"arguments", arguments}, {"pairs", from}, {"counts", counts}});
        scan(counts, blocks * kRadixDigits);
        run(kRadixKernels[1], blocks, {{"arguments", arguments}, {"pairs", from}, {"starts", counts}, {"sorted", to}});
        std::swap(from, to);
    }
    return from;
}

const Kernel& PhotonMap::compiled(const std::string& file, uint64_t effects) {
    KernelHandle& kernel = kernels_[{file, effects}];
    if (!kernel) kernel = device().compile(file, effects);
    return *kernel;
}

double PhotonMap::kernel_seconds() const {
    double sum = 0;
    for (const auto& [file, seconds] : device().statistics().kernel_s) sum += seconds;
    return sum;
}

}  // namespace lampyris

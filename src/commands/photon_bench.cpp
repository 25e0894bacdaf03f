#include "commands/photon_bench.h"

#include "accel/photons/collect/collect_host.h"
#include "core/photons/photon_map.h"

#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <random>
#include <span>
#include <thread>

namespace lampyris {
namespace {

constexpr const char* kConsumer = "accel/photons/collect/collect.consumer.h";

using kernel::CollectResult;

// The median of at least three runs' seconds.
double median_seconds(const PhotonBenchSettings& settings, const std::function<void()>& work) {
    using Clock = std::chrono::steady_clock;
    work();  // warm-up: memory, caches, compilers that wait for the first dispatch
    std::vector<double> times;
    double sum = 0;
    while (times.size() < 3 || sum < settings.seconds) {
        const auto start = Clock::now();
        work();
        times.push_back(std::chrono::duration<double>(Clock::now() - start).count());
        sum += times.back();
    }
    std::nth_element(times.begin(), times.begin() + std::ptrdiff_t(times.size() / 2), times.end());
    return times[times.size() / 2];
}

using SortItem = std::pair<uint32_t, uint32_t>;  // key, index

// Radix sort, eight bits at a time, of the same number of items on each thread; communication between threads is not included.
void radix_sort(std::span<SortItem> items, std::span<SortItem> other) {
    for (unsigned shift = 0; shift < 32; shift += 8) {
        std::array<size_t, 257> starts{};
        for (const SortItem& item : items) ++starts[(item.first >> shift & 255) + 1];
        for (size_t i = 1; i < starts.size(); ++i) starts[i] += starts[i - 1];
        for (const SortItem& item : items) other[starts[item.first >> shift & 255]++] = item;
        std::swap(items, other);
    }
}

// Photons and queries on surfaces look like "planar"; caustics like "clustered".
class Points {
 public:
    Points(const std::string& distribution, uint32_t seed) : distribution_(distribution), random_(seed) {
        std::mt19937 shape(1);
        for (glm::vec3& centre : centres_) centre = {unit_(shape), unit_(shape), unit_(shape)};
    }
    glm::vec3 next() {
        const glm::vec3 u(unit_(random_), unit_(random_), unit_(random_));
        if (distribution_ == "uniform") return u;
        if (distribution_ == "planar") return {u.x, u.y, 0.5f};
        std::normal_distribution<float> normal(0.0f, 0.01f);
        const glm::vec3 centre = centres_[size_t(u.x * float(centres_.size())) % centres_.size()];
        return centre + glm::vec3(normal(random_), normal(random_), normal(random_));
    }
    // The radius within which a query finds `found` of `count` photons, on average. (For clusters: queries have the photons'
    // distribution, so the mean density is that of a Gaussian of twice the variance.)
    float radius(double found, uint32_t count) const {
        const double pi = glm::pi<double>();
        if (distribution_ == "planar") return float(std::sqrt(found / (pi * count)));
        const double ball = std::cbrt(found / (4.0 / 3.0 * pi * count));
        if (distribution_ == "uniform") return float(ball);
        return float(ball * std::cbrt(double(centres_.size())) * 0.01 * std::sqrt(4.0 * pi));
    }

 private:
    std::string distribution_;
    std::mt19937 random_;
    std::uniform_real_distribution<float> unit_{0.0f, 1.0f};
    std::array<glm::vec3, 20> centres_;
};

}  // namespace

std::vector<std::string> photon_distributions() { return {"uniform", "clustered", "planar"}; }

double PhotonBenchFloor::of(const ConstructionTraffic& traffic) const {
    return traffic.accesses * scatter_ns + traffic.atomics * atomic_ns + traffic.sorted_bits / 32.0 * sort_ns;
}

PhotonBenchFloor measure_floor(Device& device, uint32_t points, const PhotonBenchSettings& settings) {
    PhotonBenchFloor floor;
    const glm::uvec4 arguments(points, 0, 0, 0);
    const BufferHandle count = device.create_buffer(sizeof arguments, "benchmark arguments");
    count->upload(&arguments, sizeof arguments);
    const auto measure = [&](const char* file, const char* name, size_t bytes) {
        const KernelHandle kernel = device.compile(file, 0);
        const NamedBuffer buffers[] = {{"arguments", count}, {name, device.create_buffer(bytes * points, "benchmark")}};
        const double seconds =
            median_seconds(settings, [&] { device.run(*kernel, nullptr, buffers, 0, span_count(points)); });
        return seconds * 1e9 / points;
    };
    floor.scatter_ns = measure("accel/photons/bench/bench_scatter.kernel.h", "records", 16);
    floor.atomic_ns = measure("accel/photons/bench/bench_atomic.kernel.h", "counters", 4);

    return floor;
}

double measure_sort(uint32_t points, unsigned threads, const PhotonBenchSettings& settings) {
    std::mt19937 random(1);
    std::vector<SortItem> unsorted(points), items(points), other(points);
    for (uint32_t i = 0; i < points; ++i) unsorted[i] = {uint32_t(random()), i};
    const double seconds = median_seconds(settings, [&] {
        std::vector<std::jthread> workers;
        for (unsigned t = 0; t < threads; ++t) {
            const size_t begin = size_t(points) * t / threads, end = size_t(points) * (t + 1) / threads;
            workers.emplace_back([&, begin, end] {
                std::copy(&unsorted[begin], &unsorted[begin] + (end - begin), &items[begin]);
                radix_sort(std::span(items).subspan(begin, end - begin), std::span(other).subspan(begin, end - begin));
            });
        }
    });
    return seconds * 1e9 / points;
}

PhotonBenchRow measure_photon_map(Device& device, const std::string& structure, uint32_t points,
                                  const std::string& distribution, const PhotonBenchFloors& floors,
                                  const PhotonBenchSettings& settings) {
    PhotonBenchRow row;
    row.structure = structure;
    row.backend = device.backend();
    row.distribution = distribution;
    row.points = points;
    const std::unique_ptr<PhotonMap> map = create_photon_map(structure);
    row.parameters = show_photon_map(parse_plugin_choice(structure).name, *map);

    Points photon_points(distribution, 2), query_points(distribution, 3);
    std::vector<kernel::PhotonRecord> photons(points);
    PhotonSet set;
    set.low = glm::vec3(1e30f);
    set.high = glm::vec3(-1e30f);
    for (uint32_t i = 0; i < points; ++i) {
        const glm::vec3 position = photon_points.next();
        set.low = glm::min(set.low, position);
        set.high = glm::max(set.high, position);
        photons[i] = make_photon(position, glm::vec3(0, 0, 1), glm::vec3(1.0f), i);
    }
    set.radius = photon_points.radius(settings.found, points);
    std::vector<glm::vec4> queries(settings.queries);
    for (glm::vec4& query : queries) query = glm::vec4(query_points.next(), set.radius);
    set.photons = device.create_buffer(photons.size() * sizeof(photons[0]), "photons");
    set.photons->upload(photons.data(), photons.size() * sizeof(photons[0]));
    set.queries = device.create_buffer(queries.size() * sizeof(queries[0]), "queries");
    set.queries->upload(queries.data(), queries.size() * sizeof(queries[0]));
    set.count = points;
    set.query_count = settings.queries;
    set.mean_power = 1.0f;
    const BufferHandle results = device.create_buffer(queries.size() * sizeof(CollectResult), "results");
    const PhotonConsumer consumer{kConsumer, 0, nullptr, {{"results", results}}};

    map->open(device);
    map->prepare(consumer);
    row.construction_ns_per_point = median_seconds(settings,
                                                   [&] {
                                                       ++set.pass;
                                                       map->build(set);
                                                   }) *
                                    1e9 / points;
    const double built_points = map->capabilities().needs_queries ? settings.queries : points;
    const ConstructionTraffic traffic = map->traffic();
    row.floor_ns_per_point = (traffic.one_thread ? floors.one_thread : floors.all).of(traffic) * built_points / points;
    row.query_ns = median_seconds(settings, [&] { map->gather(consumer, set.queries, 0, settings.queries); }) * 1e9 /
                   settings.queries;
    row.bytes_per_point = double(map->memory_bytes()) / points;
    std::vector<CollectResult> found(settings.queries);
    results->download(found.data(), found.size() * sizeof(found[0]));
    double sum = 0;
    for (const CollectResult& result : found) sum += result.sum.w;
    row.photons_found_mean = sum / settings.queries;
    return row;
}

}  // namespace lampyris

#include "integrators/photon_paths/photon_host.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace lampyris {
namespace {

double kernel_seconds(const Device& device, const char* file) {
    const std::map<std::string, double> seconds = device.statistics().kernel_s;
    const auto found = seconds.find(file);
    return found == seconds.end() ? 0.0 : found->second;
}

// The inverse of ordered_bits (hit_radius.kernel.h).
float from_ordered_bits(uint32_t bits) {
    return std::bit_cast<float>((bits & 0x80000000u) != 0u ? bits & 0x7fffffffu : ~bits);
}

}  // namespace

void run_in_phase(RenderSession& session, const char* file, const Kernel& kernel, const char* phase,
                  std::initializer_list<NamedBuffer> buffers, uint32_t count) {
    const double before = kernel_seconds(session.device, file);
    session.device.run(kernel, session.device_scene.get(), {buffers.begin(), buffers.size()}, 0, count);
    session.add_phase(phase, kernel_seconds(session.device, file) - before);
}

PhotonCounters download_photon_counters(const Buffer& counters) {
    PhotonCounters values{};
    counters.download(&values, sizeof values);
    return values;
}

void unpack_box(const PhotonCounters& counters, kernel::PhotonPass& pass) {
    for (int c = 0; c < 3; ++c) {
        pass.low[c] = from_ordered_bits(~counters[kernel::HIT_BOX_LOW + uint32_t(c)]);
        pass.high[c] = from_ordered_bits(counters[kernel::HIT_BOX_HIGH + uint32_t(c)]);
    }
}

void add_map_statistics(RenderSession& session, const PhotonMap& map) {
    const PhotonMapStatistics statistics = map.statistics();
    session.add_phase("construction", statistics.construction_kernel_s);
    session.add_phase("gathering", statistics.gathering_kernel_s);
    session.photons.map_bytes += map.memory_bytes();
    session.photons.lost += statistics.lost_photons;
}

void note_radii(RenderSession& session, const Buffer& queries, const Buffer& hits, size_t count) {
    PhotonStatistics& photons = session.photons;
    std::vector<glm::vec4> places(count);
    queries.download(places.data(), places.size() * sizeof(glm::vec4));
    std::vector<kernel::HitPointRecord> records(count);
    hits.download(records.data(), records.size() * sizeof(kernel::HitPointRecord));
    double sum = 0.0, initial = 0.0;
    size_t found = 0;
    photons.radius_min = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < count; ++i) {
        if (places[i].w < 0.0f) continue;
        const double radius = double(places[i].w);
        sum += radius, initial += double(records[i].radiance.w), ++found;
        photons.radius_min = std::min(photons.radius_min, radius);
        photons.radius_max = std::max(photons.radius_max, radius);
    }
    photons.radius_mean = found ? sum / double(found) : 0.0;
    photons.radius_initial = found ? initial / double(found) : 0.0;
    if (!found) photons.radius_min = 0.0;
}

}  // namespace lampyris

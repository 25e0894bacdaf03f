// Measurements behind `lampyris bench photon-maps`.
#pragma once

#include "core/device/device.h"
#include "core/photons/photon_map.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace lampyris {

struct PhotonBenchSettings {
    uint32_t queries = 100'000;
    double found = 10;     // photons in range of a query, on average
    double seconds = 0.2;  // a measurement is repeated for this long, at least three times; the median counts
};

// Nanoseconds per point of work that no structure can avoid: writing a record of 16 bytes to, and incrementing a counter at, a
// random address among as many as there are points; and a radix sort of 32-bit keys with their indices.
struct PhotonBenchFloor {
    double scatter_ns = 0, atomic_ns = 0, sort_ns = 0;
    // For the traffic that a structure cannot avoid.
    double of(const ConstructionTraffic& traffic) const;
};
struct PhotonBenchFloors {
    PhotonBenchFloor all, one_thread;  // with all of a device's threads; with one, if it has threads at all
};
// All but the sort, which does not run on the device.
PhotonBenchFloor measure_floor(Device& device, uint32_t points, const PhotonBenchSettings& settings);
double measure_sort(uint32_t points, unsigned threads, const PhotonBenchSettings& settings);

struct PhotonBenchRow {
    std::string structure;  // as asked for
    std::vector<std::pair<std::string, std::string>> parameters;
    std::string backend, distribution;
    uint32_t points = 0;
    double construction_ns_per_point = 0, floor_ns_per_point = 0, query_ns = 0, bytes_per_point = 0,
           photons_found_mean = 0;
};
PhotonBenchRow measure_photon_map(Device& device, const std::string& structure, uint32_t points,
                                  const std::string& distribution, const PhotonBenchFloors& floors,
                                  const PhotonBenchSettings& settings);

std::vector<std::string> photon_distributions();  // uniform, clustered, planar

}  // namespace lampyris

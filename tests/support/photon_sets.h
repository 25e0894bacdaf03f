// Photons and queries for tests of photon maps, in every distribution that may break a structure.
#pragma once

#include "accel/photons/collect/collect_host.h"
#include "core/photons/photon_map.h"
#include "support/device_run.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace lampyris::test {

using kernel::CollectResult;
inline constexpr const char* kCollect = "accel/photons/collect/collect.consumer.h";

struct PhotonCase {
    std::string name;
    std::vector<kernel::PhotonRecord> photons;
    std::vector<glm::vec4> queries;
    glm::vec3 low, high;
    float radius = 0;  // the largest
};

std::vector<std::string> photon_case_names();
// Half of the queries are at positions of photons, the rest near and around them; radii vary. Keys are a permutation of the
// indices.
PhotonCase make_photon_case(const std::string& name, uint32_t photons, uint32_t queries, uint32_t seed = 1);

// A case's photons and queries on a device.
PhotonSet upload_case(Device& device, const PhotonCase& photon_case);

// Whether the device has the features that the map needs; maps that need none run everywhere.
bool can_run(const Device& device, const PhotonMap& map);

// Builds and gathers on a device.
std::vector<CollectResult> collect(Device& device, PhotonMap& map, const PhotonSet& set);

// Whether both found the same photons: by the sum of hashed keys. For maps with sums only, by the number and the power of the
// photons found; the reference adds up floats, with a relative error of at most n * 2^-24.
bool same_photons(const CollectResult& found, const CollectResult& expected, bool sums_only);

// Fails if one of the maps, on any of these backends that can run it, finds other photons than brute force finds on the CPU.
void expect_exact(const std::vector<std::string>& maps, const std::vector<PhotonCase>& cases,
                  const std::vector<std::string>& backends = kernel_backends());

// Names of maps, with parameters, that guarantee exactness: each with its defaults and with the parameters that tests need.
std::vector<std::string> exact_photon_maps();

}  // namespace lampyris::test

// Photons and queries for tests of photon maps, in every shape that breaks a structure.
#pragma once

#include "core/photon_map.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace lampyris::test {

struct CollectResult {  // of accel/collect/collect.layout.h
    glm::vec4 sum;
    glm::uvec4 found;
};
inline constexpr const char* kCollect = "accel/collect/collect.consumer.h";

struct PhotonCase {
    std::string name;
    std::vector<kernel::PhotonRecord> photons;
    std::vector<glm::vec4> queries;
    glm::vec3 low, high;
    float radius = 0;  // the largest
};

std::vector<std::string> photon_case_names();
// Half of the queries lie where photons do, the rest near and about them; radii vary. Keys are a permutation of the indices.
PhotonCase make_photon_case(const std::string& name, uint32_t photons, uint32_t queries, uint32_t seed = 1);

// A case's photons and queries on a device.
PhotonSet upload_case(Device& device, const PhotonCase& photon_case);

// Whether the device has what the map asks for; maps that ask for nothing run everywhere.
bool can_run(const Device& device, const PhotonMap& map);

// Builds and gathers on a device.
std::vector<CollectResult> collect(Device& device, PhotonMap& map, const PhotonSet& set);

// Whether both found the same: by the sum of hashed keys, or where a map knows sums only, by the number and the power of what was
// found; the reference adds up floats, with a relative error of n * 2^-24 at most.
bool same_photons(const CollectResult& found, const CollectResult& expected, bool sums_only);

// Fails where one of the maps, on any backend that can run it, finds anything but what brute force finds on the CPU.
void expect_exact(const std::vector<std::string>& maps, const std::vector<PhotonCase>& cases);

// Names of maps, with parameters, that promise exactness: each in its default state and in those that tests ask for.
std::vector<std::string> exact_photon_maps();

}  // namespace lampyris::test

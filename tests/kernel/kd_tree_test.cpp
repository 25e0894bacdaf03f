// Cases that are particularly hard for a kd-tree; photon_map_test and photon_map_long_test cover the rest.
#include "support/photon_sets.h"

#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace lampyris {
namespace {

using namespace test;

const std::vector<std::string> kMaps{"kd_tree", "kd_tree:leaf=4", "kd_tree:leaf=64"};

// Each octave of distance from a point has the same number of photons: splits at the spatial middle remove one octave at a
// time, so that the tree becomes deeper than a query's stack, and is split by key below that. Queries find some photons, or
// all.
TEST(KdTree, PhotonsOfEveryScale) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(1.0f, 2.0f);
    for (const bool along_a_line : {false, true}) {
        PhotonCase photon_case;
        photon_case.name = along_a_line ? "octaves of a line" : "octaves";
        photon_case.low = glm::vec3(INFINITY);
        photon_case.high = glm::vec3(-INFINITY);
        for (uint32_t i = 0; i < 3000; ++i) {
            const float size = std::exp2(-float(i % 50));
            const float x = size * uniform(random), y = size * uniform(random), z = size * uniform(random);
            const glm::vec3 p = along_a_line ? glm::vec3(x) : glm::vec3(x, y, z);
            photon_case.low = glm::min(photon_case.low, p);
            photon_case.high = glm::max(photon_case.high, p);
            photon_case.photons.push_back(make_photon(p, glm::vec3(0, 0, 1), glm::vec3(1.0f), i * 77777u));
            photon_case.queries.emplace_back(p, i % 7 == 0 ? 5.0f : 0.3f * size);
        }
        photon_case.radius = 5.0f;
        expect_exact(kMaps, {photon_case});
    }
}

// From none to more than fit into leaves and groups of cells.
TEST(KdTree, FewPhotons) {
    std::vector<PhotonCase> cases;
    for (uint32_t photons = 1; photons < 300; photons += 1 + photons / 4)
        for (const char* name : {"random", "planar", "coincident", "few_places"})
            cases.push_back(make_photon_case(name, photons, 60, photons));
    expect_exact(kMaps, cases);
}

TEST(KdTree, ABoxThatIsWrongCostsNoPhotons) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<PhotonCase> cases;
    for (const auto& [low, high] :
         {std::pair(0.4f, 0.6f), std::pair(-1e9f, 1e9f), std::pair(5.0f, 6.0f), std::pair(1.0f, 0.0f),
          std::pair(INFINITY, -INFINITY), std::pair(-INFINITY, INFINITY), std::pair(nan, nan), std::pair(-3e38f, 3e38f),
          std::pair(0.5f, 0.5f)}) {
        cases.push_back(make_photon_case("random", 3000, 300));
        cases.back().low = glm::vec3(low);
        cases.back().high = glm::vec3(high);
        cases.push_back(cases.back());
        cases.back().low.y = 0.0f;
        cases.back().high.y = 1.0f;
    }
    expect_exact(kMaps, cases);
}

}  // namespace
}  // namespace lampyris

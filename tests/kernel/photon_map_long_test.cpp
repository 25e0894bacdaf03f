// Exact photon maps find what brute force finds: 10^4 photons with 10^6 queries, 10^6 photons with 10^3, for points of every shape.
#include "support/photon_sets.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lampyris {
namespace {

using namespace test;

class PhotonMapLong : public testing::TestWithParam<std::string> {};

TEST_P(PhotonMapLong, ExactOnesFindWhatBruteForceFinds) {
    // If each query finds every photon, there is no look-up to test, and each map would have to add 10^10 photons.
    static const std::vector<std::string> kCrowded{"coincident", "underflowing_radius", "all_in_range", "few_places"};
    const bool crowded = std::find(kCrowded.begin(), kCrowded.end(), GetParam()) != kCrowded.end();
    expect_exact(exact_photon_maps(), {make_photon_case(GetParam(), 10'000, crowded ? 10'000 : 1'000'000)});
    expect_exact(exact_photon_maps(), {make_photon_case(GetParam(), 1'000'000, crowded ? 50 : 1000)});
}

INSTANTIATE_TEST_SUITE_P(Shapes, PhotonMapLong, testing::ValuesIn(photon_case_names()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace lampyris

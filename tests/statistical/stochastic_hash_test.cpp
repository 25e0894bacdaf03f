// Stochastic hashing is unbiased, and as noisy as theory predicts: for fixed photons, over the random grid, hash and selection.
// stochastic_hash_long_test covers the complete table.
#include "core/photons/photon_map.h"
#include "support/device_run.h"
#include "support/hash_variance.h"
#include "support/photon_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace lampyris {
namespace {

using namespace test;

TEST(StochasticHash, TheoryAgreesWithItself) {
    // Known values, and the closed form for one slot.
    EXPECT_NEAR(kappa(4), 4.36, 0.01);
    EXPECT_NEAR(kappa(2), 0.770, 1e-3);
    EXPECT_NEAR(kappa(1.5), 0.340, 1e-3);
    EXPECT_NEAR(kappa(1), 0.104, 1e-3);
    EXPECT_NEAR(kappa(0.5), 0.013, 1e-3);
    for (const double lambda : {1.0, 10.0})
        for (const double cell : {2.0, 1.0})
            EXPECT_NEAR(expected_excess(lambda, cell, 1, 1) / (lambda * kappa(cell) + 1), 1.0, 2e-3);
}

TEST(StochasticHash, ExcessVarianceIsLambdaKappaPlusLoad) {
    const auto device = create_device("cpu");
    for (VarianceSettings settings :
         {VarianceSettings{.lambda = 10, .cell = 2}, {.lambda = 4, .cell = 1}, {.lambda = 1, .cell = 2, .load = 64}}) {
        settings.photons = 1 << 15;
        expect_excess(*device, settings);
    }
}

TEST(StochasticHash, SlotsLessenItAsDrawingWithoutReplacementDoes) {
    const auto device = create_device("cpu");
    expect_excess(*device, {.photons = 1 << 15, .lambda = 10, .cell = 2, .slots = 2});
}

// The mean over passes is the full sum, for flux and for count. One number a pass, the sum over queries: passes are
// independent, queries of one are not. 2 sums x 6 selections x 2 cases, each with a false-alarm rate of 1e-6.
TEST(StochasticHash, IsUnbiased) {
    constexpr double kFalseAlarm = 1e-6;
    constexpr uint32_t kPasses = 200;
    const auto device = create_device("cpu");
    const auto exact = create_photon_map("sorted_grid");
    exact->open(*device);
    for (const char* choice : {"stochastic_hash:selection=race", "stochastic_hash", "stochastic_hash:selection=flux",
                               "stochastic_hash:slots=3,table_size=0.25", "stochastic_hash:table_size=0.01",
                               "stochastic_hash:selection=flux,table_size=0.05,cell_size=0.7"}) {
        const auto map = create_photon_map(choice);
        map->open(*device);
        for (const char* name : {"random", "clustered"}) {
            SCOPED_TRACE(std::string(choice) + " " + name);
            PhotonCase photon_case = make_photon_case(name, 20'000, 2000);
            std::sort(photon_case.photons.begin(), photon_case.photons.end(),
                      [](const auto& a, const auto& b) { return a.flux.z < b.flux.z; });
            Mean flux, count;
            for (uint32_t pass = 0; pass < kPasses; ++pass) {
                // The photons are ordered by their power, as those of a store are by their depth.
                PhotonSet set = upload_case(*device, photon_case);
                set.pass = pass;
                const auto truth = collect(*device, *exact, set), found = collect(*device, *map, set);
                double flux_error = 0, count_error = 0;
                for (size_t q = 0; q < found.size(); ++q) {
                    flux_error += double(found[q].sum.z) - double(truth[q].sum.z);
                    count_error += double(found[q].sum.w) - double(truth[q].sum.w);
                }
                flux.add(flux_error);
                count.add(count_error);
            }
            EXPECT_LT(std::abs(flux.value() / flux.error()), normal_threshold(kFalseAlarm));
            EXPECT_LT(std::abs(count.value() / count.error()), normal_threshold(kFalseAlarm));
        }
    }
}

}  // namespace
}  // namespace lampyris

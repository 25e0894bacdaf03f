// The complete table of the noise of stochastic hashing: see stochastic_hash_test.cpp.
#include "support/hash_variance.h"

#include <gtest/gtest.h>

namespace lampyris {
namespace {

using namespace test;

TEST(StochasticHashLong, ExcessVarianceIsLambdaKappaPlusLoad) {
    const auto device = create_device("cpu");
    for (const double lambda : {1.0, 4.0, 10.0, 20.0})
        for (const double cell : {2.0, 1.0, 0.5})
            for (const uint32_t load : {1u, 64u})
                expect_excess(*device, {.lambda = lambda, .cell = cell, .load = load});
}

TEST(StochasticHashLong, SlotsLessenItAsDrawingWithoutReplacementDoes) {
    const auto device = create_device("cpu");
    for (const uint32_t slots : {1u, 2u, 4u, 8u})
        for (const double lambda : {4.0, 10.0, 20.0})
            for (const double cell : {2.0, 1.0})
                // With eight slots, the noise is small and hard to measure: more passes.
                expect_excess(*device, {.lambda = lambda, .cell = cell, .slots = slots, .passes = 24 * slots});
}

}  // namespace
}  // namespace lampyris

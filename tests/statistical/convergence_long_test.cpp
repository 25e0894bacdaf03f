// convergence_test for three values of alpha, with more seeds and passes. The prediction for "these passes" follows from the
// radii of the fitted passes; for n to infinity it tends to the limit.
#include "support/convergence.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace lampyris::test {
namespace {

class ConvergenceLong : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Alphas, ConvergenceLong, testing::Values(2.0 / 3.0, 0.7, 0.8));

TEST_P(ConvergenceLong, VarianceFallsAsTheoryHasIt) {
    const double alpha = GetParam();
    const ConvergenceSlopes s = measure_convergence(
        {.alpha = alpha, .seeds = 400, .first_seed = 30000, .passes = 4096, .first = 64, .photons = 300});
    std::printf("alpha %.4f: variance %.4f +- %.4f (these passes %.4f, limit %.4f)\n", alpha, s.variance,
                s.variance_error, s.expected_variance, -alpha);
    EXPECT_NEAR(s.variance, s.expected_variance, 5 * s.variance_error);
    EXPECT_LT(s.variance_error, 0.015);  // 2/3 and 0.7 are 0.033 apart
}

TEST_P(ConvergenceLong, BiasFallsAsTheoryHasIt) {
    const double alpha = GetParam();
    const ConvergenceSlopes s = measure_convergence(
        {.alpha = alpha, .seeds = 64, .first_seed = 20000, .passes = 4096, .first = 128, .sampler = "sobol"});
    std::printf("alpha %.4f: bias^2 %.4f +- %.4f (these passes %.4f, limit %.4f)\n", alpha, s.bias_squared,
                s.bias_squared_error, s.expected_bias_squared, -(2 - 2 * alpha));
    EXPECT_NEAR(s.bias_squared, s.expected_bias_squared, 5 * s.bias_squared_error);
    EXPECT_LT(s.bias_squared_error, 0.005);
}

}  // namespace
}  // namespace lampyris::test

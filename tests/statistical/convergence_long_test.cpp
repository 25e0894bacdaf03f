// convergence_test for three values of alpha, with more seeds and passes.
#include "support/convergence.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace lampyris::test {
namespace {

class ConvergenceLong : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Alphas, ConvergenceLong, testing::Values(2.0 / 3.0, 0.7, 0.8));

TEST_P(ConvergenceLong, SlopesAreThoseOfTheory) {
    const double alpha = GetParam();
    const ConvergenceSlopes s = measure_convergence(alpha, 128, 1024, 16);
    std::printf("alpha %.4f: variance %.4f +- %.4f (these passes %.4f, limit %.4f); bias^2 %.4f +- %.4f (%.4f, %.4f)\n",
                alpha, s.variance, s.variance_error, s.expected_variance, -alpha, s.bias_squared, s.bias_squared_error,
                s.expected_bias_squared, -(2 - 2 * alpha));
    EXPECT_NEAR(s.variance, s.expected_variance, 5 * s.variance_error);
    EXPECT_NEAR(s.bias_squared, s.expected_bias_squared, 5 * s.bias_squared_error);
    EXPECT_LT(s.variance_error, 0.025);  // alphas of 2/3 and 0.8 are 0.13 apart
    EXPECT_LT(s.bias_squared_error, 0.05);
}

}  // namespace
}  // namespace lampyris::test

// Bias and variance of memoryless progressive photon mapping fall as theory predicts where radiance is smooth: variance as
// n^-alpha, squared bias as n^-(2 - 2 alpha) (Knaus and Zwicker 2011; Kaplanyan and Dachsbacher 2013).
//
// After n passes, the mean of the radii has not reached its asymptotic behaviour: the slopes of finite sums, which the test
// computes, are e.g. -0.62 between 32 and 1024 passes, where the limit is -2/3. Measured slopes are within 5 standard errors of
// those (6e-7 each, as normal variables). Bias and variance are measured separately: photons of a Sobol sequence have the same
// bias and a hundredth of the noise; independent photons have the variance of the theory.
#include "support/convergence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace lampyris::test {
namespace {

TEST(Convergence, VarianceFallsAsTheoryHasIt) {
    const double alpha = 2.0 / 3.0;
    const ConvergenceSlopes s = measure_convergence({.alpha = alpha, .seeds = 224, .photons = 300});
    for (const ConvergencePointOfSeeds& p : s.points)
        RecordProperty("after_" + std::to_string(p.passes), std::to_string(p.variance) + " variance");
    EXPECT_NEAR(s.variance, s.expected_variance, 5 * s.variance_error)
        << "+- " << s.variance_error << ", in the limit " << -alpha;
    EXPECT_LT(s.variance_error, 0.025);  // the test can tell: alpha = 0.8 has -0.8
    EXPECT_NEAR(s.expected_variance, -alpha, 0.03);
}

TEST(Convergence, BiasFallsAsTheoryHasIt) {
    const double alpha = 2.0 / 3.0;
    const ConvergenceSlopes s =
        measure_convergence({.alpha = alpha, .seeds = 6, .passes = 1024, .first = 32, .sampler = "sobol"});
    for (const ConvergencePointOfSeeds& p : s.points)
        RecordProperty("after_" + std::to_string(p.passes), std::to_string(p.bias) + " bias");
    EXPECT_NEAR(s.bias_squared, s.expected_bias_squared, 5 * s.bias_squared_error)
        << "+- " << s.bias_squared_error << ", in the limit " << -(2 - 2 * alpha);
    EXPECT_LT(s.bias_squared_error, 0.015);  // alpha = 0.8 has -0.4
    EXPECT_NEAR(s.expected_bias_squared, -(2 - 2 * alpha), 0.05);
}

// |estimate - truth| <= |bias| + z sqrt(variance of both) for each pixel of the window, over many runs. Neighbouring pixels share photons,
// so runs count, not pixels: their mean coverage has the spread of 24 runs. A stated 90 % must not fall below 90 % by more than
// chance (false alarms: 1e-6); it may be higher, because the bias estimate is noisy and enters as its absolute value.
TEST(Convergence, TheStatedConfidenceHoldsWhereRadianceIsSmooth) {
    for (const double confidence : {0.5, 0.9}) {
        SCOPED_TRACE(confidence);
        const Mean coverage = measure_coverage(confidence, 24, 64);
        EXPECT_GT(coverage.value(), confidence - normal_threshold(1e-6) * coverage.error());
        EXPECT_LT(coverage.error(), 0.06);
        RecordProperty("coverage", std::to_string(coverage.value()));
        std::printf("confidence %.2f: the error stays below in %.3f +- %.3f\n", confidence, coverage.value(),
                    coverage.error());
    }
}

// The estimated bias is the true bias.
TEST(Convergence, TheEstimatedBiasIsRight) {
    const BiasEstimate bias = measure_bias(32, 32);
    EXPECT_LT(std::abs(bias.estimated.value() - bias.expected),
              normal_threshold(1e-6) * bias.estimated.error() + 0.1 * std::abs(bias.expected))
        << bias.estimated.value() << " +- " << bias.estimated.error() << " against " << bias.expected;
    EXPECT_LT(bias.estimated.error(), 0.1 * std::abs(bias.expected));
}

}  // namespace
}  // namespace lampyris::test

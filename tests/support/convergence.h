// How the error of progressive photon mapping falls: bias and variance separately, on a plane under a spot light.
#pragma once

#include "support/render.h"
#include "support/statistics.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lampyris::test {

// Radiance of a small window of the plane after 2, 4, 8, ... passes, relative to the truth.
struct ConvergencePointOfSeeds {
    uint64_t passes = 0;
    double bias = 0.0;      // mean over seeds and pixels
    double variance = 0.0;  // over seeds, mean over pixels
};

struct ConvergenceSlopes {
    double bias_squared = 0.0, variance = 0.0;                    // d log / d log passes
    double bias_squared_error = 0.0, variance_error = 0.0;        // standard errors, by the jackknife over seeds
    double expected_bias_squared = 0.0, expected_variance = 0.0;  // of these very passes, from the radii
    std::vector<ConvergencePointOfSeeds> points;
};

struct ConvergenceSettings {
    double alpha = 2.0 / 3.0;  // of memoryless radii
    int seeds = 128;
    uint32_t first_seed = 1000;
    uint32_t passes = 256;
    uint64_t first = 8;       // the passes that are fitted: from this one on
    uint32_t photons = 3000;  // emitted a pass
    // `sobol` has the same bias with less variance, whose slope then differs from theory's.
    std::string sampler = "independent";
};
ConvergenceSlopes measure_convergence(const ConvergenceSettings& settings);

// The share of the window's pixels whose error stays below the image's channel `error`, run by run.
Mean measure_coverage(double confidence, int seeds, uint32_t passes);

struct BiasEstimate {
    Mean estimated;         // the image's channel `bias`, over the truth: mean over the window, run by run
    double expected = 0.0;  // from the radii of the passes, to the order that the estimate has: r^2 times the Laplacian
};
BiasEstimate measure_bias(int seeds, uint32_t passes);

}  // namespace lampyris::test

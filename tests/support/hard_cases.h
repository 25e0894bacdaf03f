// Scenes whose radiance is known in closed form, and that are hard for floats, for rays or for samplers. docs/numerics.md lists
// them.
#pragma once

#include "support/render.h"

#include <string>
#include <vector>

namespace lampyris::test {

struct HardCase {
    std::string name;
    std::string scene;
    double radiance;  // the mean of all pixels
    // Relative: what float arithmetic, or the scene's own approximation, may cost.
    double tolerance;
    uint32_t samples = 16;
    std::string settings;  // of every integrator: "maxdepth=250"
    std::vector<std::string> integrators{"path", "bdpt", "vcm", "mlt", "sppm"};
    double power = 0.05;          // an error of this share of the radiance is found
    std::string photon_map = {};  // the default one
    // Hard for rays: by default tested with the other tracer, too; and a few of these on Vulkan. hard_cases_long_test has all.
    bool for_tracers = false, for_vulkan = false;
};

const std::vector<HardCase>& hard_cases();

struct Measured {
    double mean, standard_error;
    uint64_t non_finite;
};

// The mean over kSeeds independent images.
Measured measure_case(const HardCase& hard, const std::string& integrator, const std::string& backend);

// Fails if the mean is not the case's. The mean of kSeeds is off by more than kErrors of its standard errors (a t distribution with
// kSeeds - 1 degrees of freedom) with a probability of 2e-7: below 1e-4 for the 400 comparisons of a suite.
constexpr uint32_t kSeeds = 16;
constexpr double kErrors = 9.0;
void expect_case(const HardCase& hard, const std::string& integrator, const std::string& backend);

}  // namespace lampyris::test

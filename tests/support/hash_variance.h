// The noise of stochastic hashing: theory (photons are Poisson on a plane, the grid is shifted at random), and a measurement.
#pragma once

#include "core/device/device.h"
#include "support/statistics.h"

#include <cstdint>
#include <string>

namespace lampyris::test {

// c^2 / (pi r^2) - E[sum_c A_c^2] / (pi r^2)^2 for a disc of radius r = 1 on a square grid of side c, shifted at random.
double kappa(double cell);

// E[sum_b m (n - m) (n - k) / (k (n - 1))] / lambda over buckets of n photons, m of them in the query's disc, k slots: photons are
// Poisson on the plane, `lambda` in a disc, `load` per bucket of the table. For k = 1 it is lambda * kappa + load.
double expected_excess(double lambda, double cell, double load, uint32_t slots);

struct VarianceSettings {
    uint32_t photons = 1 << 16;
    double lambda = 1;  // photons in a query's disc
    double cell = 2;    // in radii
    uint32_t load = 1;  // photons per bucket
    uint32_t slots = 1;
    uint32_t queries = 20'000, sets = 6, passes = 24;
};

// The variance over the random grid, hash and selection for fixed photons, divided by lambda: the mean over photon sets on a
// planar patch. One number per set, because its queries share photons and passes.
Mean measured_excess(Device& device, const VarianceSettings& settings);

// Whether both agree within 3 %, if the measurement is precise enough.
void expect_excess(Device& device, const VarianceSettings& settings);

}  // namespace lampyris::test

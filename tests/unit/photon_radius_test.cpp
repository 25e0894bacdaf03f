// The schedule of radii against the product that defines it.
#include "integrators/photon_paths/progressive.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lampyris {
namespace {

// From pass k - 1 to k, the squared radius is multiplied by (k + alpha) / (k + 1) (Knaus and Zwicker 2011, equation
// 18).
// The closed form takes differences of logarithms of Gamma functions, which are up to 1e5 here: 1e-10 is a few of their
// rounding errors.
TEST(PhotonRadius, IsTheProductOfItsSteps) {
    for (const double alpha : {0.01, 0.5, 2.0 / 3.0, 0.75, 1.0}) {
        double product = 1.0;
        for (uint64_t pass = 0; pass < 10000; ++pass) {
            if (pass > 0) product *= (double(pass) + alpha) / (double(pass) + 1.0);
            ASSERT_NEAR(memoryless_scale(pass, alpha) / product, 1.0, 1e-10) << "pass " << pass << ", alpha " << alpha;
        }
    }
}

}  // namespace
}  // namespace lampyris

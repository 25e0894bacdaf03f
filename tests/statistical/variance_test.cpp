// The film's variance of a pixel's mean is that which pixels have from seed to seed, from two samples on, where n and n - 1 differ by half.
//
// Pixels have samples of their own, so that the mean over all of them of (variance told - variance seen) is normal, with the spread of
// these differences as its error. False alarms: 1e-6 for each backend and number of samples, at fixed seeds.
#include "support/runs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace lampyris::test {
namespace {

class Variance : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, Variance, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

TEST_P(Variance, IsThatFromSeedToSeed) {
    const std::string scene = R"(
LookAt 0 0 2  0 0 0  0 1 0
Camera "orthographic" "float screenwindow" [ -0.1 0.1 -0.1 0.1 ]
Sampler "independent"
PixelFilter "box"
Film "rgb" "integer xresolution" 64 "integer yresolution" 64
WorldBegin
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "point3 P" [ -9 -9 0  9 -9 0  9 9 0  -9 9 0 ] "integer indices" [ 0 1 2 0 2 3 ]
AreaLightSource "diffuse" "rgb L" [ 1 1 1 ] "bool twosided" true
Shape "trianglemesh" "point3 P" [ -3 1 3  3 1 3  3 1 0.1  -3 1 0.1 ] "integer indices" [ 0 1 2 0 2 3 ]
)";
    constexpr uint32_t kSeeds = 16;
    for (const uint32_t samples : {2u, 3u, 8u}) {
        SCOPED_TRACE(samples);
        const std::vector<Rendered> runs =
            render_text_seeds(scene, settings_of(GetParam(), "path:maxdepth=1", samples, 0), kSeeds);
        const int told = runs[0].image.find_channel("variance.G");
        Mean difference, variance;
        for (int y = 0; y < runs[0].height; ++y) {
            for (int x = 0; x < runs[0].width; ++x) {
                Mean value, estimate;
                for (const Rendered& run : runs) {
                    value.add(run.value(x, y, 1));
                    estimate.add(run.value(x, y, told));
                }
                const double seen = value.error() * value.error() * kSeeds;
                difference.add(estimate.value() - seen);
                variance.add(seen);
            }
        }
        EXPECT_LT(std::abs(difference.value()), normal_threshold(kAlpha) * difference.error())
            << "told " << variance.value() + difference.value() << ", seen " << variance.value();
        // Power: over n in place of n - 1 is off by 1/8 of the variance even for 8 samples, and is found with certainty.
        EXPECT_LT(2.0 * normal_threshold(kAlpha) * difference.error(), variance.value() / 8.0);
    }
}

}  // namespace
}  // namespace lampyris::test

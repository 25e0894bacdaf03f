// ppm: light from sampled lights, which is not known when hit points are found, is sampled again in each pass. False alarms: at
// most 4e-6 per test and backend (pass_noise.h), at fixed seeds.
#include "support/pass_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace lampyris::test {
namespace {

class PpmNoise : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, PpmNoise, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

// Nothing in between: cos 45 + 3 / sqrt 10.
TEST_P(PpmNoise, OfTwoDistantLightsAveragesOut) {
    expect_new_noise_in_each_pass(GetParam(), two_suns("Material \"diffuse\" \"rgb reflectance\" [ 1 1 1 ]\n"),
                                  std::sqrt(0.5) + 3.0 / std::sqrt(10.0), 0.0);
}

TEST_P(PpmNoise, OfManyLightsAndAMaskAveragesOut) {
    static const PassNoise reference = noise_of(many_lamps(), settings_of("cpu", "path:maxdepth=8", 2048, 0), 1.0);
    expect_new_noise_in_each_pass(GetParam(), many_lamps(), reference.mean, reference.mean_error);
}

// On Vulkan this is in ppm_noise_long_test, because lavapipe takes long to compile coats.
TEST(PpmNoiseOfCoats, AveragesOut) {
    for (const char* backend : {"cpu", "cpu-bvh2"}) {
        SCOPED_TRACE(backend);
        expect_new_noise_on_a_coat(backend);
    }
}

// One light behind a mask: a random choice by the shadow ray would be the same in every pass, with a variance of 2/3. The
// remaining variance is that of the choice of a light: the speck's lights take a few samples.
TEST_P(PpmNoise, OfAMaskIsNone) {
    const std::string scene = spot_scene(
        0.002, 0.5,
        "LightSource \"distant\" \"rgb L\" [ 3.14159265 3.14159265 3.14159265 ] \"point3 from\" [ 0 0 2 ] "
        "\"point3 to\" [ 0 0 0 ]\n"
        "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\n"
        "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \"point3 P\" [ -2 -2 1 2 -2 1 2 2 1 -2 2 1 ] "
        "\"float alpha\" 0.4\n"
        "Material \"diffuse\" \"rgb reflectance\" [ 1 1 1 ]\n");
    const PassNoise noise = noise_of(scene, settings_of(GetParam(), "ppm:maxdepth=1", 64, 0), 0.6);
    EXPECT_LT(std::abs(noise.mean - 0.6), 4.9 * noise.mean_error + 1e-6) << noise.mean;
    EXPECT_LT(noise.variance, 0.005 * noise.mean * noise.mean);
}

}  // namespace
}  // namespace lampyris::test

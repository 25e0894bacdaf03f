// A hundred thousand passes, with radii that reach their floor on the way: the mean is still that of the closed form. One image of
// 2 x 2 pixels; the noise is that of its own estimate. False alarms: 6 standard errors, 2e-9 each. Power: the tolerance.
#include "support/render.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace lampyris::test {
namespace {

using Case = std::pair<std::string, double>;  // integrator with its parameters, and the relative error that may be

class ManyPasses : public testing::TestWithParam<std::tuple<Case, std::string>> {};

TEST_P(ManyPasses, KeepTheMean) {
    const auto& [integrator, tolerance] = std::get<0>(GetParam());
    RenderSettings settings;
    settings.backend = std::get<1>(GetParam());
    settings.integrator = integrator;
    settings.samples = 100000;
    const Rendered image = render_text(
        "LookAt 0 0.5 0  0 0 0  0 0 1\nCamera \"orthographic\" \"float screenwindow\" [ -1 1 -1 1 ]\n"
        "Film \"rgb\" \"integer xresolution\" 2 \"integer yresolution\" 2\nPixelFilter \"box\"\nSampler "
        "\"independent\"\n"
        "WorldBegin\nLightSource \"point\" \"rgb I\" [ 1 1 1 ] \"point3 from\" [ 0 1 0 ]\nMaterial \"diffuse\" \"rgb "
        "reflectance\" [ 0.5 0.5 0.5 ]\nShape \"trianglemesh\" \"point3 P\" [ -3 0 -3 -3 0 3 3 0 3 3 0 -3 ] \"integer "
        "indices\" [ 0 1 2 0 2 3 ]\n",
        settings);
    // The mean irradiance of the square is its solid angle from the lamp over its area.
    const double expected = 0.5 / std::numbers::pi * 4.0 * std::atan(1.0 / std::sqrt(3.0)) / 4.0;
    double variance = 0.0;
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 2; ++x) variance += image.luminance_variance(x, y) / 16.0;
    const double error = image.mean_luminance() - expected;
    std::printf("%s on %s: %.7f, expected %.7f, error %+.1e, standard error %.1e\n", integrator.c_str(),
                settings.backend.c_str(), image.mean_luminance(), expected, error / expected,
                std::sqrt(variance) / expected);
    EXPECT_EQ(image.summary.non_finite, 0u);
    EXPECT_LE(std::abs(error), tolerance * expected + 6.0 * std::sqrt(variance));
    EXPECT_LE(6.0 * std::sqrt(variance), 0.05 * expected);
}

// Radii of photon maps shrink from 0.3 to a floor of 0.127, which they reach within 200 passes; over a disk of that radius, the
// irradiance differs from that of its centre by at most r^2 / 2 times its Laplacian, less than 1 %.
std::vector<Case> cases() {
    const std::string floor = "radius=0.3,minradius=0.03,maxdepth=1,direct=photons,photonsperiteration=20";
    return {{"path:maxdepth=1", 1e-4},
            {"light:maxdepth=1,lightpaths=20", 1e-4},
            {"bdpt:maxdepth=1", 1e-4},
            {"vcm:maxdepth=1,radius=0.3", 1e-2},
            {"bpm:maxdepth=1,radius=0.3,lightpaths=100", 1e-2},
            {"mlt:maxdepth=1,bootstrapsamples=64,chains=4", 1e-4},
            {"sppm:schedule=shared," + floor, 1e-2},
            {"sppm:schedule=memoryless," + floor, 1e-2},
            {"ppm:schedule=shared," + floor, 1e-2}};
}

INSTANTIATE_TEST_SUITE_P(Integrators, ManyPasses,
                         testing::Combine(testing::ValuesIn(cases()), testing::Values("cpu", "cpu-bvh2")),
                         [](const auto& info) {
                             std::string name = std::get<0>(std::get<0>(info.param)) + "_" + std::get<1>(info.param);
                             for (char& c : name)
                                 if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                             return name;
                         });

}  // namespace
}  // namespace lampyris::test

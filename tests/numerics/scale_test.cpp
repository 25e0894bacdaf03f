// A scene and the same scene scaled by 10^k give the same image, from the smallest to the largest scale that is allowed; the
// next ones are refused. Radiance does not depend on scale, and the random numbers are the same.
#include "support/build_text.h"
#include "support/paired.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lampyris::test {
namespace {

// Radius about 7, coordinates up to 5 (the floor's corners, tilted): 10^11 times that is below 1e12, 10^-9 times above 1e-9.
constexpr int kLeast = -9, kMost = 11;

// Every shape with a normal, in positions that are not parallel to an axis: a floor of triangles, a bilinear patch, quadrics
// and instances, under a sky and a lamp.
std::string scene(int exponent, const std::string& integrator) {
    const double s = std::pow(10.0, exponent);
    return fmt::format(
        "LookAt {0:.17g} {1:.17g} {2:.17g}  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 50\n"
        "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\n{4}WorldBegin\n"
        "LightSource \"infinite\" \"rgb L\" [ 0.3 0.4 0.5 ]\n"
        "ObjectBegin \"thing\"\nShape \"sphere\" \"float radius\" 0.4\n"
        "Shape \"trianglemesh\" \"point3 P\" [ -.5 .5 0 .5 .4 0 0 1 .3 ] \"integer indices\" [ 0 1 2 ]\nObjectEnd\n"
        "Scale {3:.17g} {3:.17g} {3:.17g}\nRotate 25 1 2 0.5\nMaterial \"diffuse\" \"rgb reflectance\" [ 0.7 0.7 0.7 "
        "]\n"
        "Shape \"trianglemesh\" \"point3 P\" [ -3 0 -3 -3 0 3 3 0 3 3 0 -3 ] \"integer indices\" [ 0 1 2 0 2 3 ]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [ -2.5 .2 -2 -1.5 .3 -2.1 -2.6 .9 -1 -1.4 .2 -1.2 ]\n"
        "AttributeBegin Translate 1.5 .6 0 Shape \"sphere\" \"float radius\" .5 AttributeEnd\n"
        "AttributeBegin Translate -1 .5 1 Rotate 40 1 1 0 Shape \"cylinder\" \"float radius\" .3 AttributeEnd\n"
        "AttributeBegin Translate 0 .7 -1 Rotate 70 1 0 .2 Shape \"disk\" \"float radius\" .6 AttributeEnd\n"
        "AttributeBegin Translate .2 .5 1.4 Scale 1 .7 1.2 ObjectInstance \"thing\" AttributeEnd\n"
        "AreaLightSource \"diffuse\" \"rgb L\" [ 4 3 2 ]\n"
        "Shape \"trianglemesh\" \"point3 P\" [ -1 3 -1 1 3 -1 1 3.2 1 ] \"integer indices\" [ 0 1 2 ]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [ 1 2.5 -1 2 2.5 -1 1 2.6 0 2 2.5 0 ]\n"
        "Translate -1.5 2 0 Shape \"sphere\" \"float radius\" .3\n",
        3 * s, 4 * s, 5 * s, s, integrator);
}

class ScaleTest : public testing::TestWithParam<std::string> {
 protected:
    void expect_same(const std::string& integrator, const std::vector<int>& exponents, uint32_t samples) {
        RenderSettings settings;
        settings.backend = GetParam();
        settings.samples = samples;
        settings.seed = 5;
        settings.sampler = "independent";
        settings.share_device = integrator.find("path") != std::string::npos;
        const Rendered ordinary = render_text(scene(0, integrator), settings);
        EXPECT_GT(ordinary.mean_luminance(), 0.1);
        for (const int exponent : exponents) {
            const Rendered scaled = render_text(scene(exponent, integrator), settings);
            EXPECT_EQ(scaled.summary.non_finite, 0u);
            const Paired found = compare_paired(ordinary, scaled);
            fmt::print("{:9} 10^{:<3} {:+.1e} (+- {:.1e})\n", GetParam(), exponent, found.relative_difference,
                       found.standard_error);
            // Rounding, and a sample or two that rounding moves to the other side of an edge.
            EXPECT_LT(std::abs(found.relative_difference), 1e-5 + 6.0 * found.standard_error) << "10^" << exponent;
            EXPECT_LT(found.standard_error, 1e-3) << "10^" << exponent;
        }
    }
};

TEST_P(ScaleTest, PathsAreTheSame) {
    expect_same("Integrator \"path\" \"integer maxdepth\" 4\n", {kLeast, -6, -3, 3, 6, 8, 9, 10, kMost}, 32);
}

TEST_P(ScaleTest, PhotonsAreTheSame) {
    expect_same("Integrator \"sppm\" \"integer maxdepth\" 3 \"integer photonsperiteration\" 2000\n",
                {kLeast, -5, 5, kMost}, 8);
}

INSTANTIATE_TEST_SUITE_P(Backends, ScaleTest, testing::ValuesIn(usable_backends()), [](const auto& info) {
    std::string name = info.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

TEST(Scale, TheNextOnesAreRefused) {
    EXPECT_EQ(build_text(scene(kLeast, "")).all_errors(), "");
    EXPECT_EQ(build_text(scene(kMost, "")).all_errors(), "");
    const std::string small = build_text(scene(kLeast - 1, "")).all_errors();
    EXPECT_NE(small.find("the scene is too small for rays to be traced"), std::string::npos) << small;
    EXPECT_NE(small.find("1e-09"), std::string::npos) << small;
    const std::string large = build_text(scene(kMost + 1, "")).all_errors();
    EXPECT_NE(large.find("farther out than rays are traced"), std::string::npos) << large;
    EXPECT_NE(large.find("1e+12"), std::string::npos) << large;
}

}  // namespace
}  // namespace lampyris::test

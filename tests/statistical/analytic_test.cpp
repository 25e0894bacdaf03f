// Scenes whose image is known in closed form (scenes/analytic; each scene's comment derives it), path-traced on every backend.
#include "core/image/image_io.h"
#include "support/analytic.h"

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>

namespace lampyris::test {
namespace {

// ---- Light that goes round and round -----------------------------------------------------------------------------------

TEST_P(AnalyticTest, ClosedBoxIsInEquilibrium) {
    render("box-equilibrium", 256);
    expect_mean(constant(3.0), 0.03);
}

TEST_P(AnalyticTest, ClosedBoxSumsTheGeometricSeries) {
    render("box-half", 256);
    expect_mean(constant(2.0), 0.02);
    render("box-bright", 256);
    expect_mean(constant(5.0), 0.03);
}

TEST_P(AnalyticTest, SphereAroundAPointLightIsUniform) {
    render("sphere-point", 256);
    expect_mean(constant(1.0), 0.02);
}

// Without roulette, every path adds up the same series, whose length is the path's.
TEST_P(AnalyticTest, SphereAroundAPointLightHasNoNoiseWithoutRoulette) {
    render("sphere-point", 1, "path:maxdepth=24,rrdepth=1000");
    expect_exact(constant(1.0 - std::ldexp(1.0, -24)), 2e-5);
    render("sphere-point", 1, "path:maxdepth=1");
    expect_exact(constant(0.5), 2e-6);
}

// ---- Furnaces ----------------------------------------------------------------------------------------------------------

TEST_P(AnalyticTest, ClearGlassIsInvisibleInAFurnace) {
    render("furnace-glass", 16);
    expect_exact(constant(1.0), 2e-5);
}

TEST_P(AnalyticTest, ThinGlassInterfacesAndMasksAreInvisibleInAFurnace) {
    render("furnace-thin", 16);
    expect_exact(constant(1.0), 2e-5);
}

// Reflectance of unpolarised light by Fresnel's formulas for a complex index.
double fresnel_metal(double cosine, std::complex<double> index) {
    const std::complex<double> refracted = std::sqrt(1.0 - (1.0 - cosine * cosine) / (index * index));
    const std::complex<double> parallel = (index * cosine - refracted) / (index * cosine + refracted);
    const std::complex<double> across = (cosine - index * refracted) / (cosine + index * refracted);
    return (std::norm(parallel) + std::norm(across)) / 2.0;
}

TEST_P(AnalyticTest, PerfectMirrorReflectsWhatPbrtsBoundLeaves) {
    render("furnace-mirror", 1);
    const std::complex<double> index(1.0, 2.0 * std::sqrt(0.9999 / 0.0001));
    expect_exact(
        [&](double x, double y, int) {
            const double sine = std::hypot(x - 8.0, y - 8.0) * 2.4 / 16.0 / 0.9;
            return sine < 1.0 ? fresnel_metal(std::sqrt(1.0 - sine * sine), index) : 1.0;
        },
        1e-5);
}

TEST_P(AnalyticTest, LosslessDiffuseMaterialsAreInvisibleInAFurnace) {
    render("furnace-diffuse", 256);
    expect_mean(constant(1.0), 0.02);
}

// A lamp of 1 behind a black mask that stops 3/4 of the rays. If the mask stopped 2 % fewer, that would be found.
TEST_P(AnalyticTest, MasksStopTheirShareOfRays) {
    scene_ = "mask";
    RenderSettings settings;
    settings.backend = GetParam();
    settings.samples = 128;
    settings.sampler = "independent";
    settings.integrator = "path:maxdepth=0";
    last_ = render_text(R"(
Camera "orthographic"
PixelFilter "box"
Film "rgb" "integer xresolution" 32 "integer yresolution" 32
WorldBegin
AttributeBegin
Material "diffuse" "rgb reflectance" [ 0 0 0 ]
Shape "disk" "float radius" 2 "float height" 1 "float alpha" 0.75
AttributeEnd
AreaLightSource "diffuse" "rgb L" [ 1 1 1 ] "bool twosided" true
Shape "disk" "float radius" 2 "float height" 2
)",
                        settings);
    expect_mean(constant(0.25), 0.06);
}

// ---- Irradiance --------------------------------------------------------------------------------------------------------

double polygon_irradiance(const std::vector<glm::dvec3>& corners, glm::dvec3 p) {
    double sum = 0.0;
    for (size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = glm::normalize(corners[i] - p), b = glm::normalize(corners[(i + 1) % corners.size()] - p);
        sum += std::acos(glm::dot(a, b)) * glm::normalize(glm::cross(a, b)).y;
    }
    return std::abs(sum) / 2.0;
}

// Configuration factor of a parallel disk at height h, with a lateral offset a (scenes/analytic/lamp-disk.pbrt).
double disk_factor(double radius, double height, double aside) {
    const double h2 = aside * aside / (height * height), r2 = radius * radius / (height * height), z = 1.0 + h2 + r2;
    return 0.5 * (1.0 - (z - 2.0 * r2) / std::sqrt(z * z - 4.0 * h2 * r2));
}

TEST_P(AnalyticTest, RectangleLampsFollowLambert) {
    const std::vector<glm::dvec3> corners{{-0.5, 0.8, -0.4}, {0.7, 1.0, -0.4}, {0.7, 1.3, 0.5}, {-0.5, 1.1, 0.5}};
    for (const char* scene : {"lamp-rectangle", "lamp-patch"}) {
        render(scene, 128);
        expect_mean(floor_radiance([&](glm::dvec3 p) { return polygon_irradiance(corners, p); }), 0.03);
    }
}

TEST_P(AnalyticTest, DiskLampHasItsConfigurationFactor) {
    render("lamp-disk", 128);
    expect_mean(
        floor_radiance([](glm::dvec3 p) { return kPi * disk_factor(0.5, 1.0, std::hypot(p.x - 0.2, p.z + 0.1)); }),
        0.03);
}

TEST_P(AnalyticTest, CylinderLampIsADifferenceOfDisks) {
    render("lamp-cylinder", 128);
    expect_mean(floor_radiance([](glm::dvec3 p) {
                    const double aside = std::hypot(p.x - 0.1, p.z - 0.2);
                    return kPi * (disk_factor(1.7, 0.5, aside) - disk_factor(1.7, 1.0, aside));
                }),
                0.05);
}

TEST_P(AnalyticTest, SphereLampFollowsItsSolidAngle) {
    render("lamp-sphere", 64);
    expect_mean(floor_radiance([](glm::dvec3 p) {
                    const glm::dvec3 to = glm::dvec3(0.3, 1.0, 0.2) - p;
                    const double d2 = glm::dot(to, to);
                    return kPi * 0.16 / d2 * to.y / std::sqrt(d2);
                }),
                0.03);
}

TEST_P(AnalyticTest, SkyGivesPiTimesItsRadiance) {
    render("lamp-sky", 64);
    expect_mean(floor_radiance([](glm::dvec3) { return kPi; }), 0.03);
}

TEST_P(AnalyticTest, DistantLightFollowsTheCosine) {
    render("lamp-distant", 4);
    expect_exact(floor_radiance([](glm::dvec3) { return 3.0 / std::sqrt(14.0); }), 2e-6);
}

TEST_P(AnalyticTest, PointLightFollowsTheInverseSquare) {
    render("lamp-point", 4);
    expect_exact(floor_radiance([](glm::dvec3 p) {
                     const glm::dvec3 to = glm::dvec3(0.3, 0.9, -0.2) - p;
                     return to.y / std::pow(glm::dot(to, to), 1.5);
                 }),
                 1e-4);  // the filter's width
}

TEST_P(AnalyticTest, SpotLightFallsOffSmoothly) {
    render("lamp-spot", 4);
    const glm::dvec3 from(0.2, 0.9, 0.1), axis = glm::normalize(glm::dvec3(-0.2, 0.0, 0.0) - from);
    int lit = 0, dark = 0, between = 0;
    const Expected expected = floor_radiance([&](glm::dvec3 p) {
        const glm::dvec3 to = from - p;
        const double d2 = glm::dot(to, to);
        const double outer = std::cos(35.0 * kPi / 180.0), inner = std::cos(20.0 * kPi / 180.0);
        const double t = std::clamp((glm::dot(axis, -to) / std::sqrt(d2) - outer) / (inner - outer), 0.0, 1.0);
        ++(t <= 0.0 ? dark : t >= 1.0 ? lit : between);
        return t * t * (3.0 - 2.0 * t) * to.y / std::pow(d2, 1.5);
    });
    expect_exact(expected, 5e-4, 0.1);
    EXPECT_GT(lit, 50);
    EXPECT_GT(dark, 50);
    EXPECT_GT(between, 50);
}

// ---- Surfaces that are looked at or through ----------------------------------------------------------------------------

TEST_P(AnalyticTest, PictureShowsItself) {
    const Rendered& image = render("texture-mean", 2);
    const Image texture = read_image(std::string(LAMPYRIS_SOURCE_DIR) + "/scenes/reference/texture.png", {true, true});
    ASSERT_EQ(texture.width, image.width);
    ASSERT_EQ(texture.height, image.height);
    std::array<double, 3> sum{}, expected_sum{};
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                sum[size_t(c)] += image.value(x, y, c);
                expected_sum[size_t(c)] += texture.at(x, y, c);
            }
        }
    }
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / expected_sum[c], 1.0, 1e-5) << "channel " << c;
    expect_exact([&](double x, double y, int c) { return double(texture.at(int(x), int(y), c)); }, 5e-4, 0.5);
}

TEST_P(AnalyticTest, GlassTransmitsAllReflectionsToAndFro) {
    render("pane", 64);
    expect_mean(constant(12.0 / 13.0), 0.03);
}

TEST_P(AnalyticTest, MetalPlateFollowsFresnel) {
    render("mirror", 4);
    expect_exact(
        [](double, double, int c) {
            return fresnel_metal(1.0, {std::array{0.2, 1.0, 2.0}[size_t(c)], std::array{3.0, 2.0, 1.0}[size_t(c)]});
        },
        5e-6);
}

TEST_P(AnalyticTest, ThinLensKeepsTheLight) {
    const Rendered& image = render("thin-lens", 512);
    const int variance = image.image.find_channel("variance.R");
    const double half = std::tan(4.0 * kPi / 180.0), pixel = 2.0 * half / image.width;  // on the film at distance 1
    double sum = 0.0, sum_variance = 0.0, middle = 0.0, middle_variance = 0.0;
    int inside = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            sum += image.value(x, y, 0);
            sum_variance += image.value(x, y, variance);
            // The pixel's nearest and farthest points from the axis, in the plane of the disk.
            const double px = std::abs(x + 0.5 - image.width / 2.0), py = std::abs(y + 0.5 - image.height / 2.0);
            const double nearest = 4.0 * pixel * std::hypot(std::max(0.0, px - 0.5), std::max(0.0, py - 0.5));
            const double farthest = 4.0 * pixel * std::hypot(px + 0.5, py + 0.5);
            if (nearest > 0.1501) {
                EXPECT_EQ(image.value(x, y, 0), 0.0f) << x << ", " << y;
            }
            if (farthest < 0.05) {
                ++inside;
                middle += image.value(x, y, 0) - 0.25;
                middle_variance += image.value(x, y, variance);
            }
        }
    }
    const double expected = kPi * 0.05 * 0.05 / (16.0 * pixel * pixel);
    const double deviation = std::sqrt(sum_variance);
    fmt::print("{:18} {:9} light kept {:+.3f} % (z {:+.2f}); middle off by {:+.3f} (z {:+.2f}, {} pixels)\n",
               "thin-lens", GetParam(), 100.0 * (sum / expected - 1.0), (sum - expected) / deviation, middle / inside,
               middle / std::sqrt(middle_variance), inside);
    EXPECT_LT(std::abs(sum - expected), kZLimit * deviation);
    EXPECT_LT(kPowerLimit * deviation / expected, 0.08);
    EXPECT_GE(inside, 12);
    EXPECT_LT(std::abs(middle), kZLimit * std::sqrt(middle_variance));
}

LAMPYRIS_ANALYTIC_TESTS(AnalyticTest);

}  // namespace
}  // namespace lampyris::test

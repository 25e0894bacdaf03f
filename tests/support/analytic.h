// Comparing an image with a closed form, pixel by pixel: for tests of scenes/analytic.
//
// Noisy scenes: samples are independent, so a mean's z = (mean - expected) / sqrt(sum of the pixels' variances) is standard
// normal, except for the tails of single samples, which are averaged over at least 4096 of them. The tests cover, per channel,
// the whole image and its quarters: 15 numbers per scene, at |z| < 6, with a false-alarm rate of 2e-9 each. 15 noisy scenes x
// 15 x 3 backends: 1.4e-6 for the suite. Seeds are fixed, so that a test that passes once does not fail by chance later.
// Power: a relative bias of 8.4 standard errors of the whole image's mean is found with probability 0.99. Each test states how
// large a bias must be to be found like this, and fails if its samples do not suffice for that.
// Scenes without noise: every pixel equals the closed form, except for rounding.
#pragma once

#include "support/render.h"

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

namespace lampyris::test {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kZLimit = 6.0, kPowerLimit = kZLimit + 2.4;

// Expected radiance of a channel at raster coordinates (pixels; centres at .5).
using Expected = std::function<double(double x, double y, int channel)>;

class AnalyticTest : public testing::TestWithParam<std::string> {
 protected:
    void TearDown() override {
        if (HasFailure() && !last_.image.pixels.empty()) {
            std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
            std::replace(name.begin(), name.end(), '/', '_');
            save_failure("analytic_" + name, last_.image);
        }
    }

    const Rendered& render(const std::string& scene, uint32_t samples, const std::string& integrator = {}) {
        scene_ = scene;
        RenderSettings settings;
        settings.backend = GetParam();
        settings.samples = samples;
        settings.seed = 20240229;
        settings.sampler = "independent";
        settings.integrator = integrator;
        last_ = render_file(std::string(LAMPYRIS_SOURCE_DIR) + "/scenes/analytic/" + scene + ".pbrt", settings);
        EXPECT_EQ(last_.summary.non_finite, 0u);
        return last_;
    }

    // z of the mean over a window against the closed form.
    struct Window {
        double z, relative_error, relative_deviation;
    };
    Window compare(const Expected& expected, int x0, int y0, int x1, int y1, int channel) const {
        double difference = 0.0, variance = 0.0, total = 0.0;
        const int first = last_.image.find_channel("variance.R");
        for (int y = y0; y < y1; ++y) {
            for (int x = x0; x < x1; ++x) {
                const double e = expected(x + 0.5, y + 0.5, channel);
                difference += last_.value(x, y, channel) - e;
                variance += last_.value(x, y, first + channel);
                total += e;
            }
        }
        return {difference / std::sqrt(variance), difference / total, std::sqrt(variance) / total};
    }

    // `detectable`: the relative bias of the whole image that must be found with probability 0.99.
    void expect_mean(const Expected& expected, double detectable) const {
        const int w = last_.width, h = last_.height;
        for (int c = 0; c < 3; ++c) {
            const Window whole = compare(expected, 0, 0, w, h, c);
            if (c == 1)
                fmt::print("{:18} {:9} mean {:+.4f} % of the closed form (z {:+.2f}); finds a bias of {:.3f} %\n",
                           scene_, GetParam(), 100.0 * whole.relative_error, whole.z,
                           100.0 * kPowerLimit * whole.relative_deviation);
            EXPECT_LT(std::abs(whole.z), kZLimit) << scene_ << ", channel " << c << ": off by " << whole.relative_error;
            EXPECT_LT(kPowerLimit * whole.relative_deviation, detectable)
                << scene_ << ", channel " << c << ": too noisy to tell";
            for (int quarter = 0; quarter < 4; ++quarter) {
                const int x0 = quarter % 2 * (w / 2), y0 = quarter / 2 * (h / 2);
                const Window part = compare(expected, x0, y0, x0 + w / 2, y0 + h / 2, c);
                EXPECT_LT(std::abs(part.z), kZLimit)
                    << scene_ << ", channel " << c << ", quarter " << quarter << ": off by " << part.relative_error;
            }
        }
    }

    // `scale`: the value that errors of darker pixels are relative to.
    void expect_exact(const Expected& expected, double bound, double scale = 1e-3) const {
        double worst = 0.0;
        int worst_x = 0, worst_y = 0;
        for (int y = 0; y < last_.height; ++y) {
            for (int x = 0; x < last_.width; ++x) {
                for (int c = 0; c < 3; ++c) {
                    const double e = expected(x + 0.5, y + 0.5, c);
                    const double off = std::abs(last_.value(x, y, c) - e) / std::max(std::abs(e), scale);
                    if (off > worst || std::isnan(off)) {
                        worst = off;
                        worst_x = x;
                        worst_y = y;
                    }
                }
            }
        }
        fmt::print("{:18} {:9} without noise: largest relative difference {:.1e}\n", scene_, GetParam(), worst);
        EXPECT_LT(worst, bound) << scene_ << ", pixel (" << worst_x << ", " << worst_y
                                << "): " << last_.value(worst_x, worst_y, 0) << ", expected "
                                << expected(worst_x + 0.5, worst_y + 0.5, 0);
    }

    // The floor's point under a raster point of the lamp-* scenes.
    glm::dvec3 floor_point(double x, double y) const {
        return {2.0 * x / last_.width - 1.0, 0.0, 1.0 - 2.0 * y / last_.height};
    }
    // The floor's radiance for an irradiance by a light of radiance (or intensity) 1.
    Expected floor_radiance(const std::function<double(glm::dvec3)>& irradiance) const {
        return [this, irradiance](double x, double y, int c) {
            const std::array<double, 3> light{1.0, 2.0, 4.0}, albedo{0.2, 0.5, 1.0};
            return light[size_t(c)] * albedo[size_t(c)] / kPi * irradiance(floor_point(x, y));
        };
    }

    Rendered last_;
    std::string scene_;
};

inline Expected constant(double value) {
    return [value](double, double, int) { return value; };
}

// Defines every test of a fixture for every backend.
#define LAMPYRIS_ANALYTIC_TESTS(fixture)                                                                     \
    INSTANTIATE_TEST_SUITE_P(Backends, fixture, testing::ValuesIn(usable_backends()), [](const auto& info) { \
        std::string name = info.param;                                                                       \
        std::replace(name.begin(), name.end(), '-', '_');                                                    \
        return name;                                                                                         \
    })

}  // namespace lampyris::test

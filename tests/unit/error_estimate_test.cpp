// The error that pixels predict from their own variance: against closed forms, and against pictures whose true error is known.
#include "core/render/error_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace lampyris {
namespace {

struct Picture {
    uint32_t width, height;
    std::vector<PixelEstimate> pixels;

    Picture(uint32_t w, uint32_t h, double mean, double variance) : width(w), height(h), pixels(size_t(w) * h) {
        for (PixelEstimate& pixel : pixels) set(pixel, mean, variance);
    }
    static void set(PixelEstimate& pixel, double mean, double variance) {
        pixel.radiance.fill({mean, variance});
        pixel.sees_surface = true;
        pixel.has_light = mean != 0.0;
    }
    PixelEstimate& at(uint32_t x, uint32_t y) { return pixels[size_t(y) * width + x]; }
    ErrorEstimate estimate() const {
        return estimate_error(width, height, [&](uint32_t x, uint32_t y) { return pixels[size_t(y) * width + x]; });
    }
};

// A pixel of `samples` samples, each `base` and, with the given probability, `flash` on top.
struct Flashes {
    double base, probability, flash;
    int samples;

    double mean() const { return base + probability * flash; }
    double variance() const { return probability * (1.0 - probability) * flash * flash; }  // of one sample
    // Adds a pixel's relMSE to `error`, too.
    PixelEstimate pixel(std::mt19937& random, double& error) const {
        const double k = std::binomial_distribution<int>(samples, probability)(random), n = samples;
        const double m = base + k / n * flash, off = m - mean();
        error += off * off / (mean() * mean() + 0.01);
        PixelEstimate result;
        Picture::set(result, m, k / n * (1.0 - k / n) * flash * flash / (n - 1.0));
        return result;
    }
};

// The error of a picture of flashes, and its estimate, both divided by the expected error.
struct Ratios {
    double error, estimate, share;
};

Ratios ratios(const Flashes& flashes, uint32_t side, uint32_t seed) {
    Picture picture(side, side, 0.0, 0.0);
    std::mt19937 random(seed);
    double error = 0.0;
    for (PixelEstimate& pixel : picture.pixels) pixel = flashes.pixel(random, error);
    const double r = flashes.mean(), expected = flashes.variance() / flashes.samples / (r * r + 0.01);
    const ErrorEstimate estimate = picture.estimate();
    return {error / double(picture.pixels.size()) / expected, estimate.relmse / expected, estimate.largest_share};
}

TEST(ErrorEstimate, IsTheFormulaWhereMeansAreKnown) {
    EXPECT_NEAR(Picture(7, 5, 2.0, 0.02).estimate().relmse, 0.02 / 4.01, 1e-9);
    Picture ramp(64, 3, 0.0, 0.0);  // different neighbours do not change means that are known well
    double expected = 0.0;
    for (uint32_t y = 0; y < 3; ++y)
        for (uint32_t x = 0; x < 64; ++x) {
            const double mean = 0.5 + x;
            Picture::set(ramp.at(x, y), mean, 1e-6 * mean * mean);
            expected += 1e-6 * mean * mean / (mean * mean + 0.01) / 192.0;
        }
    EXPECT_NEAR(ramp.estimate().relmse, expected, 1e-4 * expected);
}

TEST(ErrorEstimate, SeesWhatFirefliesHide) {
    // With the firefly's own mean in the denominator, the error of a pixel with one would be at most 1, while its true error is
    // 30 to 20,000. The bounds are five standard deviations of the number of flashes, and the neighbours' influence on the
    // rest.
    for (const Flashes& flashes : {Flashes{0.2, 1.0 / 500, 40.0, 16}, Flashes{0.2, 1.0 / 5000, 400.0, 64},
                                   Flashes{0.0, 1.0 / 100, 10.0, 16}, Flashes{1.0, 1.0 / 2000, 300.0, 8}}) {
        SCOPED_TRACE(flashes.flash);
        const Ratios r = ratios(flashes, 96, 1);
        EXPECT_GT(r.estimate, 0.6 * r.error);
        EXPECT_LT(r.estimate, 3.0 * r.error);
        EXPECT_NEAR(r.error, 1.0, 0.5);
    }
}

TEST(ErrorEstimate, IsRightWithoutFireflies) {
    // One sample in two is bright: a mean's relative variance is 1/n. In a denominator this makes 1/R^2 too large by three
    // times that, and the neighbours' influence by less than that again. The error itself is known to 1.5 % (9216 pixels); five
    // times that is allowed.
    for (const int samples : {16, 64, 256}) {
        SCOPED_TRACE(samples);
        const Ratios r = ratios({0.0, 0.5, 2.0, samples}, 96, 2);
        EXPECT_NEAR(r.estimate, r.error, (4.0 / samples + 0.075) * r.error);
        EXPECT_LT(r.share, 0.01);
    }
}

TEST(ErrorEstimate, LeavesTheEdgesOfLampsAlone) {
    // A lamp of 100 in a room of 0.1: for half-covered pixels on its edge, the mean is known to an eighth after 64 samples.
    Picture picture(32, 32, 0.1, 1e-6);
    for (uint32_t y = 0; y < 32; ++y) {
        Picture::set(picture.at(16, y), 50.0, 2500.0 / 64.0);
        for (uint32_t x = 17; x < 20; ++x) Picture::set(picture.at(x, y), 100.0, 0.0);
    }
    const double plain = (2500.0 / 64.0 / 2500.01 * 32.0 + 1e-6 / 0.02 * 28.0 * 32.0) / 1024.0;
    EXPECT_NEAR(picture.estimate().relmse, plain, 0.12 * plain);
}

TEST(ErrorEstimate, TellsWhatAFewPixelsMake) {
    Picture picture(100, 20, 1.0, 1.01e-4);
    Picture::set(picture.at(50, 10), 3000.0, 9e6);
    Picture::set(picture.at(3, 4), 1.0, 1.01);  // 2 of 2000 are 0.1 %
    const double one = 9e6 / 1.01;              // R is the neighbours' mean, 1
    EXPECT_NEAR(picture.estimate().relmse, (one + 1.0 + 1998e-4) / 2000.0, 1e-3 * one / 2000.0);
    EXPECT_GT(picture.estimate().largest_share, 0.999);
}

TEST(ErrorEstimate, CountsAsDarkWhatHasNoLightAround) {
    Picture picture(40, 40, 0.0, 0.0);
    EXPECT_EQ(picture.estimate().dark_share, 1.0);
    EXPECT_EQ(picture.estimate().relmse, 0.0);
    Picture::set(picture.at(20, 20), 1.0, 1.0);  // affects 5 x 5
    EXPECT_DOUBLE_EQ(picture.estimate().dark_share, (1600.0 - 25.0) / 1600.0);
    for (PixelEstimate& pixel : picture.pixels) pixel.sees_surface = false;
    EXPECT_EQ(picture.estimate().dark_share, 0.0);
}

TEST(ErrorEstimate, HoldsAtTheEnds) {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NEAR(Picture(1, 1, 1.0, 4.0).estimate().relmse, 4.0 / 1.01, 1e-9);  // the neighbours agree
    Picture picture(5, 1, 1.0, 0.5);
    picture.at(2, 0).radiance.fill({1e30, 1e60});
    EXPECT_NEAR(picture.estimate().relmse / (1e60 / 1.01 / 5.0), 1.0, 1e-9);  // not lost in a difference of sums
    picture.at(2, 0).left_out = true;
    EXPECT_NEAR(picture.estimate().relmse, 0.5 / 1.01, 1e-9);
    picture.at(3, 0).radiance.fill({1.0, kNaN});  // one sample
    EXPECT_TRUE(std::isnan(picture.estimate().relmse));
    // Negative light, from a filter's lobes: relMSE squares it.
    EXPECT_NEAR(Picture(4, 4, -2.0, 0.02).estimate().relmse, 0.02 / 4.01, 1e-9);
}

TEST(ErrorEstimate, AddsTheBias) {
    Picture picture(4, 4, 1.0, 0.01);
    for (PixelEstimate& pixel : picture.pixels) pixel.bias_squared.fill(0.04);
    EXPECT_NEAR(picture.estimate().relmse, 0.05 / 1.01, 1e-9);
    for (PixelEstimate& pixel : picture.pixels) pixel.bias_squared.fill(-0.04);  // nothing but noise
    EXPECT_NEAR(picture.estimate().relmse, 0.01 / 1.01, 1e-9);
}

}  // namespace
}  // namespace lampyris

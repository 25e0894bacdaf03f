// The metrics against numbers worked out by hand from their formulas (docs/metrics.md).
#include "core/image/metrics.h"

#include "core/base/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lampyris {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();

Image image_of(int width, int height, std::vector<float> pixels) {
    Image image(width, height, {"R", "G", "B"});
    image.pixels = std::move(pixels);
    return image;
}

TEST(Metrics, AreTheirFormulas) {
    const Image reference = image_of(2, 1, {1.0f, 0.0f, 2.0f, 0.5f, 0.25f, 4.0f});
    const Image image = image_of(2, 1, {1.5f, 0.5f, 2.0f, 0.5f, 0.0f, 2.0f});
    const Metrics m = measure(image, reference);
    // I-R: 0.5 0.5 0 0 -0.25 -2
    EXPECT_DOUBLE_EQ(m.mse, (0.25 + 0.25 + 0.0625 + 4.0) / 6.0);
    EXPECT_DOUBLE_EQ(m.rmse, std::sqrt(4.5625 / 6.0));
    EXPECT_DOUBLE_EQ(m.relmse, (0.25 / 1.01 + 0.25 / 0.01 + 0.0625 / 0.0725 + 4.0 / 16.01) / 6.0);
    EXPECT_DOUBLE_EQ(m.relmse_trimmed, m.relmse);  // 0.1 % of two pixels is none
    EXPECT_DOUBLE_EQ(m.mape, (0.5 / 1.01 + 0.5 / 0.01 + 0.25 / 0.26 + 2.0 / 4.01) / 6.0);
    EXPECT_DOUBLE_EQ(m.smape, 2.0 * (0.5 / 2.51 + 0.5 / 0.51 + 0.25 / 0.26 + 2.0 / 6.01) / 6.0);
    EXPECT_EQ(m.mean, (std::array<double, 3>{1.0, 0.25, 2.0}));
    EXPECT_EQ(m.reference_mean, (std::array<double, 3>{0.75, 0.125, 3.0}));
    EXPECT_EQ(m.pixels, 2u);
    EXPECT_EQ(m.non_finite, 0u);
}

TEST(Metrics, TrimmingDropsTheWorstThousandth) {
    // 3500 pixels, R = 1, I - R = 0.1, except for 4 fireflies: 3 are dropped, one stays.
    Image reference(100, 35, {"R", "G", "B"}), image = reference;
    std::fill(reference.pixels.begin(), reference.pixels.end(), 1.0f);
    std::fill(image.pixels.begin(), image.pixels.end(), 1.5f);
    const float fireflies[4] = {1e15f, 3.0f, 1e6f, 1e3f};
    for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 3; ++c) image.at(7 * i, 8 * i, c) = fireflies[i];
    const Metrics m = measure(image, reference);
    EXPECT_NEAR(m.relmse_trimmed, (3496.0 * 0.25 + 4.0) / 1.01 / 3497.0, 1e-12);
    EXPECT_GT(m.relmse, 1e25);
}

TEST(Metrics, NonFinitePixelsAreCountedAndLeftOut) {
    const Image reference = image_of(4, 1, {1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, kInf});
    const Image image = image_of(4, 1, {1, 1, 2, kNan, 2, 2, 3, -kInf, 3, 4, 4, 4});
    const Comparison comparison = compare_images(image, reference);
    EXPECT_EQ(comparison.metrics.non_finite, 3u);
    EXPECT_EQ(comparison.metrics.pixels, 1u);
    EXPECT_DOUBLE_EQ(comparison.metrics.mse, 1.0 / 3.0);
    EXPECT_EQ(comparison.metrics.mean[2], 2.0);
    EXPECT_EQ(comparison.metrics.reference_mean[2], 1.0);
    EXPECT_TRUE(std::isfinite(comparison.flip.mean));
    EXPECT_GT(comparison.flip.mean, 0.0);
    for (int i = 1; i < 4; ++i) EXPECT_TRUE(std::isnan(comparison.flip.error[size_t(i)])) << i;
    const std::vector<uint8_t> picture = error_picture(comparison);
    EXPECT_EQ(std::vector<uint8_t>(picture.begin() + 3, picture.begin() + 6), (std::vector<uint8_t>{0, 255, 0}));
}

TEST(Metrics, NothingLeftIsNotANumber) {
    const Image nothing = image_of(1, 1, {kNan, 0, 0});
    const Comparison comparison = compare_images(nothing, nothing);
    EXPECT_EQ(comparison.metrics.non_finite, 1u);
    for (const MetricFormula& formula : metric_formulas())
        EXPECT_TRUE(std::isnan(comparison.metrics.*formula.value)) << formula.key;
    EXPECT_TRUE(std::isnan(comparison.flip.mean));
}

TEST(Metrics, NegativeLightKeepsDenominatorsPositive) {
    const Metrics m = measure(image_of(1, 1, {0, 0, 0}), image_of(1, 1, {-0.01f, -0.01f, -0.02f}));
    EXPECT_GT(m.mape, 0.0);
    EXPECT_LT(m.mape, 1.0);
    EXPECT_GT(m.smape, 0.0);
}

TEST(Metrics, DifferentSizesAreNamed) {
    try {
        measure(Image(4, 3, {"R", "G", "B"}), Image(5, 3, {"R", "G", "B"}));
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("4x3"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("5x3"), std::string::npos);
    }
}

TEST(Metrics, ChannelsAreComparedByNameAndExtraOnesIgnored) {
    const Image reference = image_of(1, 1, {1, 2, 3});
    Image image(1, 1, {"A", "B", "G", "R", "depth.Z"});
    image.pixels = {0.5f, 3, 2, 1, 99};
    EXPECT_EQ(measure(image, reference).mse, 0.0);
}

TEST(Metrics, IntegerFilesAreComparedAsADisplayShowsThem) {
    Image reference = image_of(2, 1, {0.5f, 0.5f, 0.5f, 1, 1, 1}), image = reference;
    EXPECT_TRUE(compare_images(image, reference).hdr);
    image.storage = Image::Storage::kUint8;
    EXPECT_FALSE(compare_images(image, reference).hdr);
    // An encoded picture is decoded first.
    image.encoding = Image::Encoding::kSrgb;
    for (float& value : image.pixels) value = srgb_from_linear(value);
    EXPECT_NEAR(compare_images(image, reference).metrics.rmse, 0.0, 1e-6);
}

}  // namespace
}  // namespace lampyris

// Our FLIP against the authors' (flip-evaluator; data/flip_expected.py made the numbers), and its properties.
#include "core/image/flip.h"

#include "core/base/error.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>

namespace lampyris {
namespace {

// The three functions below are those of data/flip_expected.py, number by number.
double noise(uint32_t x, uint32_t y, uint32_t c, uint32_t seed) {
    uint32_t h = x * 0x9E3779B1u + y * 0x85EBCA77u + c * 0xC2B2AE3Du + seed * 0x27D4EB2Fu;
    h = (h ^ (h >> 16)) * 0x85EBCA6Bu;
    h = (h ^ (h >> 13)) * 0xC2B2AE35u;
    h ^= h >> 16;
    return double(h >> 8) / 16777216.0;
}

double reference_value(int x, int y, int c, int width, int height, double peak) {
    const double ramps[3] = {double(x) / width, double(y) / height, double(x + y) / (width + height)};
    double value = ramps[c];
    if (2 * x < width && 2 * y < height) value = (x / 5 + y / 5 + c) % 2 ? 0.125 : 0.75;
    if (width - 9 <= x && x < width - 4 && 4 <= y && y < 9) value = peak;
    return value;
}

struct Pair {
    Image reference, image;
};

Pair make(int width, int height, double peak, double amount, uint32_t seed) {
    Pair pair{Image(width, height, {"R", "G", "B"}), Image(width, height, {"R", "G", "B"})};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) {
                const double value = reference_value(x, y, c, width, height, peak);
                pair.reference.at(x, y, c) = float(value);
                pair.image.at(x, y, c) =
                    float(value * (1.0 + amount * (noise(uint32_t(x), uint32_t(y), uint32_t(c), seed) - 0.5)));
            }
    for (int c = 0; c < 3; ++c) pair.image.at(width / 2, height / 2, c) *= 2.0f;
    return pair;
}

TEST(Flip, AgreesWithItsAuthorsImplementation) {
    std::ifstream file(LAMPYRIS_SOURCE_DIR "/tests/unit/data/flip_expected.json");
    ASSERT_TRUE(file);
    const nlohmann::json expected = nlohmann::json::parse(file);
    for (const auto& test : expected["cases"]) {
        SCOPED_TRACE(test["name"].get<std::string>());
        const int width = test["width"], height = test["height"];
        const Pair pair = make(width, height, test["peak"], test["amount"], test["seed"]);
        const bool hdr = test["range"] == "HDR";
        const FlipResult ours = hdr ? flip_hdr(pair.image, pair.reference) : flip_ldr(pair.image, pair.reference);
        // Both sides compute in 32-bit floats, in another order: that made differences of up to 1.6e-5 for a pixel
        // (where the exponents 0.5 and 0.7 magnify the rounding of small differences) and 2e-7 for a mean. The file has
        // five digits of a pixel. A wrong constant or border rule moves pixels by more than 1e-3.
        EXPECT_NEAR(ours.mean, test["mean"].get<double>(), 5e-6);
        for (size_t i = 0; i < ours.error.size(); ++i)
            ASSERT_NEAR(ours.error[i], test["error"][i].get<double>(), 1e-4) << "pixel " << i;
        if (!hdr) continue;
        EXPECT_EQ(ours.exposures, test["exposures"].get<int>());
        EXPECT_NEAR(ours.start_exposure, test["start_exposure"].get<double>(), 1e-4);
        EXPECT_NEAR(ours.stop_exposure, test["stop_exposure"].get<double>(), 1e-4);
    }
}

TEST(Flip, IsZeroForEqualImagesOnly) {
    const Pair pair = make(40, 30, 3.0, 0.1, 7);
    EXPECT_EQ(flip_ldr(pair.reference, pair.reference).mean, 0.0);
    EXPECT_EQ(flip_hdr(pair.reference, pair.reference).mean, 0.0);
    EXPECT_GT(flip_hdr(pair.image, pair.reference).mean, 0.01);
}

TEST(Flip, OfADisplayIsSymmetric) {
    const Pair pair = make(40, 30, 1.0, 0.3, 8);
    EXPECT_EQ(flip_ldr(pair.image, pair.reference).error, flip_ldr(pair.reference, pair.image).error);
}

TEST(Flip, StaysBetweenZeroAndOne) {
    Image black(16, 16, {"R", "G", "B"}), bright(16, 16, {"R", "G", "B"}), faint(16, 16, {"R", "G", "B"});
    std::fill(bright.pixels.begin(), bright.pixels.end(), 3e38f);
    std::fill(faint.pixels.begin(), faint.pixels.end(), 1e-20f);
    for (const Image* a : {&black, &bright, &faint})
        for (const Image* b : {&black, &bright, &faint})
            for (const FlipResult& result : {flip_hdr(*a, *b), flip_ldr(*a, *b)})
                for (const float error : result.error) {
                    ASSERT_GE(error, 0.0f);
                    ASSERT_LE(error, 1.0f);
                }
    EXPECT_GT(flip_ldr(bright, black).mean, 0.8);
    EXPECT_EQ(flip_hdr(black, black).mean, 0.0);  // no exposure suits a black reference; that must not matter
}

TEST(Flip, WorksOnImagesSmallerThanItsFilters) {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 5}, {3, 2}}) {
        Image a(width, height, {"R", "G", "B"}), b = a;
        std::fill(a.pixels.begin(), a.pixels.end(), 0.5f);
        std::fill(b.pixels.begin(), b.pixels.end(), 0.25f);
        const FlipResult result = flip_ldr(a, b);
        ASSERT_EQ(result.error.size(), size_t(width * height));
        // A constant image has no features, so every pixel shows the same colour difference.
        for (const float error : result.error) EXPECT_NEAR(error, result.error[0], 1e-6f);
        EXPECT_GT(result.error[0], 0.1f);
    }
}

TEST(Flip, DependsOnTheViewingDistance) {
    const Pair pair = make(40, 32, 1.0, 0.5, 9);
    // Farther away, more pixels per degree: noise blurs in the eye.
    EXPECT_GT(flip_ldr(pair.image, pair.reference, 20.0).mean, flip_ldr(pair.image, pair.reference, 100.0).mean);
}

TEST(Flip, RefusesImagesOfDifferentSizes) {
    EXPECT_THROW(flip_ldr(Image(4, 4, {"R", "G", "B"}), Image(4, 5, {"R", "G", "B"})), InputError);
    EXPECT_THROW(flip_hdr(Image(4, 4, {"Y"}), Image(4, 4, {"Y"})), InputError);
}

TEST(Magma, GoesFromBlackToPaleYellowWithRisingLuminance) {
    EXPECT_EQ(magma(0.0f), (std::array<uint8_t, 3>{0, 0, 4}));
    EXPECT_EQ(magma(1.0f), (std::array<uint8_t, 3>{252, 253, 191}));
    EXPECT_EQ(magma(2.0f), magma(1.0f));
    const auto luminance = [](const std::array<uint8_t, 3>& c) {
        return 0.2126f * linear_from_srgb(float(c[0]) / 255.0f) + 0.7152f * linear_from_srgb(float(c[1]) / 255.0f) +
               0.0722f * linear_from_srgb(float(c[2]) / 255.0f);
    };
    for (int i = 8; i <= 248; i += 8)
        EXPECT_GT(luminance(magma(float(i) / 255.0f)), luminance(magma(float(i - 8) / 255.0f))) << i;
}

}  // namespace
}  // namespace lampyris

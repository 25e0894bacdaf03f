// Light to display values: the views of our OpenColorIO configuration against the formulas that define them.
#include "core/image/color.h"

#include "core/base/error.h"
#include "core/image/image_io.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lampyris {
namespace {

Image greys(const std::vector<float>& values) {
    Image image(int(values.size()), 1, {"R", "G", "B"});
    for (size_t i = 0; i < values.size(); ++i)
        for (int c = 0; c < 3; ++c) image.at(int(i), 0, c) = values[i];
    return image;
}

TEST(Color, EveryViewIsListedAndDescribed) {
    const std::vector<std::string> names = view_names();
    EXPECT_NE(std::find(names.begin(), names.end(), kDefaultView), names.end());
    EXPECT_NE(std::find(names.begin(), names.end(), "Raw"), names.end());
    for (const View& view : views()) {
        EXPECT_FALSE(view.description.empty()) << view.name;
        Image image = greys({0.0f, 0.18f, 1.0f});
        EXPECT_NO_THROW(apply_view(image, view.name, 0.0f)) << view.name;
    }
}

TEST(Color, AnUnknownViewListsTheKnownOnes) {
    try {
        check_view("Standart");
        FAIL();
    } catch (const InputError& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find("Standart"), std::string::npos);
        for (const std::string& name : view_names()) EXPECT_NE(message.find(name), std::string::npos) << message;
    }
}

TEST(Color, StandardIsTheSrgbCurve) {
    std::vector<float> light;
    for (int i = 0; i <= 1000; ++i) light.push_back(float(i) / 1000.0f);
    Image image = greys(light);
    apply_view(image, "Standard", 0.0f);
    // OpenColorIO joins the two pieces where they meet smoothly, the standard at 0.0031308: they differ by 1e-5 there.
    for (size_t i = 0; i < light.size(); ++i)
        EXPECT_NEAR(image.at(int(i), 0, 1), srgb_from_linear(light[i]), 2e-5f) << light[i];
}

TEST(Color, EightBitsRoundToNearest) {
    // IEC 61966-2-1: 0.5 -> 0.735357 -> 187.5; 0.18 -> 0.461356 -> 117.6; 0.001 -> 0.01292 -> 3.29
    const std::vector<uint8_t> bytes =
        display_bytes(greys({0.0f, 0.001f, 0.18f, 0.5f, 1.0f, 7.0f, -1.0f}), "Standard", 0.0f);
    const std::vector<uint8_t> expected{0, 3, 118, 188, 255, 255, 0};
    for (size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(bytes[3 * i], expected[i]) << i;
}

TEST(Color, ExposureCountsStops) {
    EXPECT_EQ(display_bytes(greys({0.1f, 0.02f}), "Standard", 2.0f),
              display_bytes(greys({0.4f, 0.08f}), "Standard", 0.0f));
    EXPECT_EQ(display_bytes(greys({0.4f}), "ACES", -1.0f), display_bytes(greys({0.2f}), "ACES", 0.0f));
}

TEST(Color, RawIsLight) {
    Image image = greys({0.0f, 0.25f, 1.0f, 3.0f, -2.0f});
    apply_view(image, "Raw", 0.0f);
    const std::vector<float> expected{0.0f, 0.25f, 1.0f, 1.0f, 0.0f};
    for (size_t i = 0; i < expected.size(); ++i) EXPECT_FLOAT_EQ(image.at(int(i), 0, 0), expected[i]);
}

TEST(Color, LogShowsStops) {
    // From 10 stops below middle grey (0) to 6.5 stops above it (1), linear in stops.
    std::vector<float> light;
    for (int stop = -10; stop <= 6; ++stop) light.push_back(0.18f * std::exp2(float(stop)));
    Image image = greys(light);
    apply_view(image, "Log", 0.0f);
    for (size_t i = 0; i < light.size(); ++i) EXPECT_NEAR(image.at(int(i), 0, 2), float(i) / 16.5f, 1e-4f);
}

TEST(Color, AcesRollsOffAndStaysNeutral) {
    // ACES 1.0 SDR video: 0.18 is shown as 10 nits of 100 or 4.8-5.0 of 48 (the reference mid-grey), that is about 0.10 linear;
    // greys stay grey except for the primaries' rounding; light above 1 still has visible gradation.
    Image image = greys({0.0f, 0.18f, 1.0f, 2.0f, 4.0f, 16.0f});
    apply_view(image, "ACES", 0.0f);
    EXPECT_NEAR(linear_from_srgb(image.at(1, 0, 1)), 0.10f, 0.01f);
    for (int i = 1; i < image.width; ++i) {
        EXPECT_GT(image.at(i, 0, 1), image.at(i - 1, 0, 1));
        EXPECT_NEAR(image.at(i, 0, 0), image.at(i, 0, 1), 0.004f);
        EXPECT_NEAR(image.at(i, 0, 2), image.at(i, 0, 1), 0.004f);
    }
    EXPECT_LT(image.at(2, 0, 1), 0.95f);
}

TEST(Color, NonFiniteLightIsShownNotPropagated) {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    for (const std::string& view : view_names()) {
        const std::vector<uint8_t> bytes = display_bytes(greys({inf, nan, -inf, 0.0f, 1e30f}), view, 0.0f);
        EXPECT_GE(bytes[0], 250) << view;
        EXPECT_EQ(bytes[3], bytes[9]) << view << ": NaN is shown as black";
        EXPECT_EQ(bytes[6], bytes[9]) << view;
        EXPECT_EQ(bytes[12], bytes[0]) << view;
    }
}

TEST(Color, PngHoldsWhatTheViewShows) {
    const test::TemporaryFolder folder;
    const std::string path = folder / "view.png";
    const Image image = greys({0.05f, 0.5f, 2.0f});
    WriteOptions options;
    options.view = "ACES";
    options.exposure = 0.5f;
    write_image(path, image, options);
    const Image read = read_image(path, {.linear = false});
    const std::vector<uint8_t> expected = display_bytes(image, "ACES", 0.5f);
    for (size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(std::lround(read.pixels[i] * 255.0f), expected[i]);
    options.view = "nonsense";
    EXPECT_THROW(write_image(path, image, options), InputError);
}

}  // namespace
}  // namespace lampyris

// Images in memory: channels by name, crops, and the sRGB curve.
#include "core/image/image.h"

#include "core/base/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace lampyris {
namespace {

Image counted(int width, int height, std::vector<std::string> names) {
    Image image(width, height, std::move(names));
    std::iota(image.pixels.begin(), image.pixels.end(), 0.0f);
    return image;
}

TEST(Image, IsBlackAndRefusesToBeEmpty) {
    const Image image(3, 2, {"R", "G", "B"});
    EXPECT_EQ(image.pixels, std::vector<float>(18, 0.0f));
    EXPECT_THROW(Image(0, 2, {"R"}), InputError);
    EXPECT_THROW(Image(2, -1, {"R"}), InputError);
    EXPECT_THROW(Image(2, 2, {}), InputError);
}

TEST(Image, SelectsChannelsByName) {
    const Image image = counted(2, 1, {"depth.Z", "G", "R"});
    EXPECT_EQ(image.select({"R", "depth.Z"}).pixels, (std::vector<float>{2, 0, 5, 3}));
    try {
        image.select({"B"});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("depth.Z, G, R"), std::string::npos) << error.what();
    }
}

TEST(Image, AppendsChannels) {
    Image image = counted(2, 1, {"R", "G"});
    image.add_channels({"samples"}, {16, 17});
    EXPECT_EQ(image.channel_names, (std::vector<std::string>{"R", "G", "samples"}));
    EXPECT_EQ(image.pixels, (std::vector<float>{0, 1, 16, 2, 3, 17}));
    EXPECT_THROW(image.add_channels({"a", "b"}, {1, 2}), InputError);
}

TEST(Image, GreyWithAlphaBecomesColour) {
    EXPECT_EQ(counted(2, 1, {"Y", "A"}).rgb().pixels, (std::vector<float>{0, 0, 0, 2, 2, 2}));
    EXPECT_EQ(counted(1, 1, {"luminance"}).rgb().pixels, (std::vector<float>{0, 0, 0}));
}

TEST(Image, CropsOfCropsRememberTheirPlace) {
    const Image image = counted(10, 8, {"R", "G", "B"});
    const Image crop = image.crop({2, 1, 9, 7}).crop({1, 2, 4, 5});
    EXPECT_EQ(crop.at(0, 0, 0), image.at(3, 3, 0));
    EXPECT_EQ(crop.x, 3);
    EXPECT_EQ(crop.y, 3);
    EXPECT_EQ(crop.full_width, 10);
    EXPECT_EQ(crop.full_height, 8);

    Image full = image;
    full.cut_to_window_of(crop);
    EXPECT_EQ(full.pixels, crop.pixels);
    Image other = counted(11, 8, {"R", "G", "B"});
    other.cut_to_window_of(crop);
    EXPECT_EQ(other.width, 11);
    Image overscan = crop;
    overscan.x = 9;  // reaches beyond the picture
    full = image;
    full.cut_to_window_of(overscan);
    EXPECT_EQ(full.width, 10);
}

TEST(Image, TheSrgbCurveIsItsOwnInverse) {
    for (int i = 0; i <= 255; ++i) {
        const float encoded = float(i) / 255.0f;
        EXPECT_NEAR(srgb_from_linear(linear_from_srgb(encoded)), encoded, 1e-6f);
        EXPECT_EQ(linear_from_srgb(-encoded), -linear_from_srgb(encoded));
    }
    EXPECT_NEAR(linear_from_srgb(0.5f), 0.214041f, 1e-6f);  // IEC 61966-2-1
}

TEST(Image, AlphaIsNotDecoded) {
    Image image(1, 1, {"R", "A"});
    image.pixels = {0.5f, 0.5f};
    image.encoding = Image::Encoding::kSrgb;
    make_linear(image);
    EXPECT_NEAR(image.pixels[0], 0.214041f, 1e-6f);
    EXPECT_EQ(image.pixels[1], 0.5f);
    make_linear(image);  // linear already
    EXPECT_NEAR(image.pixels[0], 0.214041f, 1e-6f);
}

}  // namespace
}  // namespace lampyris

// Negative numbers in images of light are set to 0, with a warning: there is no negative light, whichever light has the image,
// and however it is sampled.
#include "core/image/image_io.h"
#include "support/build_text.h"
#include "support/runs.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lampyris::test {
namespace {

constexpr int kSide = 8;

std::string write_picture(const std::string& name, const std::vector<float>& rgb) {
    Image image(kSide, kSide, {"R", "G", "B"});
    image.pixels = rgb;
    const std::string path = failure_directory() + "/negative_light_" + name + ".pfm";
    write_image(path, image);
    return path;
}

std::vector<float> picture_with_negatives() {
    std::vector<float> rgb(size_t(3 * kSide * kSide));
    for (size_t i = 0; i < rgb.size(); ++i) rgb[i] = i % 5 == 3 ? -float(i) : float(i % 7) + 0.5f;
    return rgb;
}

std::string light(const std::string& kind, const std::string& file) {
    const std::string name = " \"string filename\" \"" + file + "\"\n";
    if (kind == "area")
        return "AreaLightSource \"diffuse\"" + name +
               "Shape \"trianglemesh\" \"point3 P\" [ -1 2 -1 1 2 -1 0 2 1 ] \"point2 uv\" [ 0 0 1 0 1 1 ]\n";
    return "LightSource \"" + kind + "\"" + name;
}

class NegativeLightOf : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Kinds, NegativeLightOf, testing::Values("infinite", "projection", "goniometric", "area"),
                         [](const auto& info) { return info.param; });

// A picture with negative numbers makes exactly the same scene as one with zeros, bit by bit: powers, distributions, texels. So
// no backend or integrator can distinguish them.
TEST_P(NegativeLightOf, IsTakenForNone) {
    std::vector<float> negative = picture_with_negatives(), clamped = negative;
    size_t count = 0;
    for (float& value : clamped) count += value < 0.0f, value = std::max(value, 0.0f);
    const std::string kind = GetParam();
    const BuiltText with = build_world(light(kind, write_picture(kind, negative)));
    const BuiltText without = build_world(light(kind, write_picture(kind + "_0", clamped)));
    EXPECT_TRUE(with.errors.empty()) << with.all_errors();
    EXPECT_TRUE(without.warnings.empty());
    EXPECT_EQ(with.scene().hash, without.scene().hash);
    ASSERT_EQ(with.warnings.size(), 1u);
    const std::string& warning = with.warnings[0];
    EXPECT_TRUE(warning.starts_with("test.pbrt:")) << warning;
    // Number 3 is the first one.
    EXPECT_NE(warning.find(std::to_string(count) + " negative numbers, the first in texel (1, 0)"), std::string::npos)
        << warning;
    EXPECT_NE(warning.find("negative_light_" + kind + ".pfm"), std::string::npos) << warning;
    EXPECT_NE(warning.find("light is at least 0"), std::string::npos) << warning;
}

// An image that is only reflected may hold any values: reflectances are clamped where they are used, and a bump map may go
// down.
TEST(NegativeLight, ReflectancesAreAnotherMatter) {
    const std::string file = write_picture("reflectance", picture_with_negatives());
    const BuiltText built = build_world("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"" + file +
                                        "\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\nShape \"sphere\"\n" +
                                        light("infinite", file));
    EXPECT_EQ(built.warnings.size(), 1u);  // only a warning about the light
}

// NaN is set to 0, infinity to the largest number, both with a warning.
TEST(NegativeLight, NumbersThatAreNotFiniteAreReplaced) {
    std::vector<float> rgb(size_t(3 * kSide * kSide), 1.0f);
    rgb[4] = std::nanf("");
    rgb[5] = -std::numeric_limits<float>::infinity();
    const BuiltText built = build_world(light("infinite", write_picture("not_finite", rgb)));
    EXPECT_TRUE(built.errors.empty()) << built.all_errors();
    ASSERT_EQ(built.warnings.size(), 2u);
    EXPECT_NE(built.warnings[0].find("2 numbers that are not finite"), std::string::npos) << built.warnings[0];
    EXPECT_NE(built.warnings[1].find("1 negative numbers"), std::string::npos) << built.warnings[1];
    for (const uint32_t bits : built.scene().texels) {
        const float value = std::bit_cast<float>(bits);
        EXPECT_TRUE(value == 0.0f || value == 1.0f) << value;
    }
}

// The same holds for spectra beyond Rec.709's gamut, and for negative values of a spectrum.
TEST(NegativeLight, SpectraMakeNone) {
    for (const char* spectrum :
         {"\"spectrum L\" [ 500 0 510 1 520 0 ]", "\"blackbody L\" 1000", "\"spectrum L\" [ 400 -1 500 1 700 -1 ]"}) {
        SCOPED_TRACE(spectrum);
        const BuiltText built = build_world(std::string("LightSource \"infinite\" ") + spectrum + "\n");
        EXPECT_TRUE(built.errors.empty()) << built.all_errors();
        const Spectrum emission = built.scene().lights.at(0).emission;
        EXPECT_GE(std::min({emission[0], emission[1], emission[2]}), 0.0f);
        EXPECT_GT(std::max({emission[0], emission[1], emission[2]}), 0.0f);
        const bool negative = std::string(spectrum).find("-1") != std::string::npos;
        EXPECT_EQ(built.warnings.size(), negative ? 1u : 0u);
        if (negative) {
            EXPECT_NE(built.warnings[0].find("holds 2 negative values"), std::string::npos) << built.warnings[0];
        }
    }
}

// What a metal is made of is no light, but is not negative either.
TEST(NegativeLight, MetalsHaveNone) {
    const auto image_of = [](const std::string& numbers) {
        return build_world("Material \"conductor\" \"spectrum eta\" [ 400 1.5 700 1.5 ] \"spectrum k\" " + numbers +
                           "\nShape \"sphere\"\n");
    };
    const BuiltText negative = image_of("[ 400 -3 700 -3 ]"), none = image_of("[ 400 0 700 0 ]");
    EXPECT_EQ(negative.all_errors() + none.all_errors(), "");
    ASSERT_EQ(negative.warnings.size(), 1u);
    EXPECT_NE(negative.warnings[0].find("holds 2 negative values"), std::string::npos) << negative.warnings[0];
    EXPECT_EQ(rgb_of(negative.scene().materials.back().color1), rgb_of(none.scene().materials.back().color1));
}

class NegativeSky : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, NegativeSky, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

TEST_P(NegativeSky, IsBlack) {
    const std::string text =
        "LookAt 0 0 3.9  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 36\nFilm \"rgb\" \"integer xresolution\" 8 "
        "\"integer yresolution\" 8\nWorldBegin\n" +
        light("infinite",
              write_picture("black_" + name_of(GetParam()), std::vector<float>(size_t(3 * kSide * kSide), -1.0f))) +
        "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 0 1 -1 0 0 1 0 ]\n";
    for (const char* integrator : {"path", "sppm:direct=photons", "photon_map:direct=photons,photons=1000"}) {
        SCOPED_TRACE(integrator);
        const Rendered image = render_text(text, settings_of(GetParam(), integrator, 2, 0));
        EXPECT_EQ(image.summary.non_finite, 0u);
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x)
                for (int c = 0; c < 3; ++c) EXPECT_EQ(image.value(x, y, c), 0.0f);
    }
}

}  // namespace
}  // namespace lampyris::test

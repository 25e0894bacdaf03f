// Spectra to linear Rec.709.
#include "core/scene/spectrum.h"

#include "support/build_text.h"

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace lampyris {
namespace {

void expect_near(glm::vec3 a, glm::vec3 b, float tolerance) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "channel " << c;
}

TEST(Spectrum, WhiteIsWhite) {
    expect_near(reflectance_rgb([](float) { return 0.5f; }), glm::vec3(0.5f), 1e-6f);
    expect_near(light_rgb(illuminant_d65), glm::vec3(1.0f), 2e-3f);
}

// The observer's integral of each function is 106.857 at 1 nm (CIE 15:2004: equal energy is X = Y = Z).
TEST(Spectrum, ObserverIsNormalized) {
    glm::vec3 sum(0.0f);
    for (float w = kFirstWavelength; w <= kLastWavelength; w += 1.0f) sum += cie_xyz(w);
    expect_near(sum, glm::vec3(106.857f), 0.1f);
    EXPECT_EQ(cie_xyz(555.0f).y, 1.0f);
    EXPECT_EQ(cie_xyz(200.0f), glm::vec3(0.0f));
}

TEST(Spectrum, BlackBodyPeaksWhereWienSays) {
    for (const float kelvin : {3000.0f, 5000.0f, 6500.0f}) {
        const float peak = 2.8977721e6f / kelvin;
        EXPECT_NEAR(blackbody(peak, kelvin), 1.0f, 1e-5f);
        EXPECT_LT(blackbody(peak * 1.1f, kelvin), 1.0f);
        EXPECT_LT(blackbody(peak * 0.9f, kelvin), 1.0f);
    }
    // Illuminant A's chromaticity is (0.44757, 0.40745) (CIE 15:2004).
    glm::vec3 xyz(0.0f);
    for (float w = kFirstWavelength; w <= kLastWavelength; w += 1.0f)
        xyz += cie_xyz(w) * named_spectrum("stdillum-A")->at(w);
    EXPECT_NEAR(xyz.x / (xyz.x + xyz.y + xyz.z), 0.44757f, 5e-4f);
    EXPECT_NEAR(xyz.y / (xyz.x + xyz.y + xyz.z), 0.40745f, 5e-4f);
}

// Wien's law, whose colour has a limit in which all is at the long end; and Rayleigh and Jeans's, T / wavelength^4.
TEST(Spectrum, BlackBodiesOfAnyTemperatureShine) {
    const auto of_temperature = [](float kelvin) {
        return light_rgb([kelvin](float w) { return visible_blackbody(w, kelvin); });
    };
    for (const float kelvin : {1000.0f, 6500.0f, 1e5f})
        expect_near(of_temperature(kelvin), light_rgb([kelvin](float w) { return blackbody(w, kelvin); }), 1e-5f);
    const glm::vec3 hottest = light_rgb([](float w) { return std::pow(w / 360.0f, -4.0f); });
    for (const float kelvin : {1e10f, 1e15f, 1e20f, 3e38f}) expect_near(of_temperature(kelvin), hottest, 1e-5f);
    EXPECT_GT(hottest.z, hottest.x);
    const glm::vec3 coldest = light_rgb([](float w) { return w == kLastSeen ? 1.0f : 0.0f; });
    EXPECT_GT(coldest.x, 1.0f);
    for (const float kelvin : {1e-30f, 1e-10f, 1.0f}) expect_near(of_temperature(kelvin), coldest, 1e-5f);
    for (const float kelvin : {1e-38f, 1.0f, 100.0f, 1e16f, 3e38f}) {
        const BuiltText built = build_world(fmt::format("LightSource \"point\" \"blackbody I\" {}\n", kelvin));
        EXPECT_EQ(built.all_errors(), "") << kelvin;
        EXPECT_GT(rgb_of(built.scene().lights.at(0).emission).x, 0.5f) << kelvin;
    }
}

// The colour of a narrow line is that of its wavelength, wherever it is between the steps of the integral.
TEST(Spectrum, NarrowLinesAreSeen) {
    for (const float middle : {555.0f, 555.35f, 610.5f, 470.001f})
        for (const float width : {0.1f, 2.0f}) {
            const std::vector<float> nodes = {middle - width, middle, middle + width};
            const auto line = [&](float w) { return std::max(0.0f, 1.0f - std::abs(w - middle) / width); };
            const glm::vec3 colour = rec709_from_xyz(cie_xyz(middle) / cie_xyz(middle).y), most = glm::abs(colour);
            expect_near(light_rgb(line, nodes), colour, 0.005f * std::max({most.x, most.y, most.z}));
        }
    const BuiltText built = build_world("LightSource \"point\" \"spectrum I\" [ 555.2 0 555.5 1 555.8 0 ]\n");
    EXPECT_GT(rgb_of(built.scene().lights.at(0).emission).y, 1.0f);
    // Reflectances of a step between two wavelengths: the part of the light that is in between.
    const auto step = [](float edge) {
        const std::vector<float> nodes = {360.0f, edge, edge + 0.01f, 830.0f};
        return reflectance_rgb([edge](float w) { return w <= edge ? 1.0f : 0.0f; }, nodes).x;
    };
    EXPECT_NEAR(step(600.5f), 0.5f * (step(600.0f) + step(601.0f)), 1e-3f);
}

TEST(Spectrum, LightThatIsNotSeenIsTold) {
    const BuiltText built = build_world("LightSource \"point\" \"spectrum I\" [ 300 1 340 1 ]\n");
    ASSERT_EQ(built.warnings.size(), 1u);
    EXPECT_NE(built.warnings[0].find("no light that is seen"), std::string::npos) << built.warnings[0];
}

TEST(Spectrum, Rec709FromXyzIsTheStandards) {
    // Rec. ITU-R BT.709-6: the luminance of red, green and blue is 0.2126, 0.7152, 0.0722.
    expect_near(rec709_from_xyz({0.95047f, 1.0f, 1.08883f}), glm::vec3(1.0f), 1e-3f);
    expect_near(rec709_from_xyz({0.4123908f, 0.2126390f, 0.0193308f}), {1.0f, 0.0f, 0.0f}, 1e-4f);
}

TEST(Spectrum, ColourSpacesKeepWhiteAndNestTheirGamuts) {
    for (const char* space : {"rec2020", "dci-p3", "aces2065-1"})
        expect_near(rec709_from(space, glm::vec3(0.7f), SpectrumUse::kAlbedo), glm::vec3(0.7f), 1e-5f);
    // ITU-R BT.2087: Rec.2020's red lies outside of Rec.709.
    expect_near(rec709_from("rec2020", {1.0f, 0.0f, 0.0f}, SpectrumUse::kAlbedo), {1.6605f, -0.1246f, -0.0182f}, 1e-3f);
    // The white of ACES is warmer than D65; a light keeps that white.
    const glm::vec3 aces = rec709_from("aces2065-1", glm::vec3(1.0f), SpectrumUse::kLight);
    EXPECT_GT(aces.x, aces.z);
}

TEST(Spectrum, MetalsReflectTheirColour) {
    for (const char* metal : {"Ag", "Al", "Au", "Cu", "CuZn", "MgO", "TiO2"}) {
        const SampledSpectrum* eta = named_spectrum(std::string("metal-") + metal + "-eta");
        const SampledSpectrum* k = named_spectrum(std::string("metal-") + metal + "-k");
        ASSERT_NE(eta, nullptr) << metal;
        ASSERT_NE(k, nullptr) << metal;
        const auto reflectance = [](float n, float a) {
            return ((n - 1) * (n - 1) + a * a) / ((n + 1) * (n + 1) + a * a);
        };
        const ConductorRgb rgb = conductor_rgb(*eta, *k);
        const auto at = [](const SampledSpectrum& s, float w) { return s.at(std::min(w, s.wavelengths.back())); };
        const glm::vec3 wanted =
            glm::min(reflectance_rgb([&](float w) { return reflectance(at(*eta, w), at(*k, w)); }), glm::vec3(0.9999f));
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(reflectance(rgb.eta[c], rgb.k[c]), wanted[c], 1e-4f) << metal << " channel " << c;
    }
}

// Results are remembered for spectra that are equal in all numbers, and for no others, however many there are.
TEST(Spectrum, RememberedOnesAreThoseComputed) {
    const auto colours = [] {
        std::string world;
        for (int i = 0; i < 600; ++i)
            world += fmt::format("LightSource \"point\" \"blackbody I\" {}\n", 1000 + 10 * i) +
                     fmt::format(
                         "Material \"conductor\" \"spectrum eta\" [ 360 {0} 830 1 ] \"spectrum k\" [ 360 3 830 {1} ]\n"
                         "Shape \"sphere\"\nMaterial \"diffuse\" \"spectrum reflectance\" [ 400 {2} 700 .5 ]\n"
                         "Shape \"sphere\"\n",
                         0.1 + 0.001 * i, 3.0 + 0.001 * i, 0.001 * i);
        const BuiltText built = build_world(world);
        EXPECT_EQ(built.all_errors(), "");
        std::vector<glm::vec3> all;
        for (const kernel::LightRecord& light : built.scene().lights) all.push_back(rgb_of(light.emission));
        for (const kernel::MaterialRecord& material : built.scene().materials) {
            all.push_back(rgb_of(material.color0));
            all.push_back(rgb_of(material.color1));
        }
        return all;
    };
    const std::vector<glm::vec3> first = colours();
    EXPECT_GE(first.size(), 3000u);
    EXPECT_EQ(first, colours());
    // Each differs from the next one in its red part: 600 lights, then pairs of materials.
    for (size_t i = 1; i < 600; ++i) EXPECT_NE(first[i].x, first[i - 1].x) << i;
    const auto at = [](float w) { return visible_blackbody(w, 6990.0f); };
    const SampledSpectrum sampled = [&] {
        SampledSpectrum s;
        for (float w = kFirstWavelength; w <= kLastWavelength; w += 5.0f)
            s.wavelengths.push_back(w), s.values.push_back(at(w));
        return s;
    }();
    const glm::vec3 expected = light_rgb([&](float w) { return sampled.at(w); });
    EXPECT_EQ(first[599], expected);
}

TEST(Spectrum, GlassHasItsCatalogueIndex) {
    // n_d at 587.6 nm (Schott's data sheets).
    EXPECT_NEAR(named_spectrum("glass-BK7")->at(587.6f), 1.51680f, 2e-4f);
    EXPECT_NEAR(named_spectrum("glass-SF11")->at(587.6f), 1.78472f, 2e-4f);
    EXPECT_NEAR(named_spectrum("glass-F11")->at(587.6f), 1.78472f, 2e-4f);
    EXPECT_NEAR(named_spectrum("glass-LASF9")->at(587.6f), 1.85025f, 2e-4f);
    EXPECT_NEAR(named_spectrum("glass-BAF10")->at(587.6f), 1.67003f, 2e-4f);
    EXPECT_NEAR(named_spectrum("glass-FK51A")->at(587.6f), 1.48656f, 2e-4f);
}

}  // namespace
}  // namespace lampyris

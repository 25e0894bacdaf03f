#include "core/scene/spectrum.h"

#include "core/image/primaries.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>

namespace lampyris {

namespace {

constexpr Primaries kRec2020{{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, kD65};
constexpr Primaries kDciP3{{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, kD65};
constexpr Primaries kAces{{0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.077}, {0.32168, 0.33767}};

// Bradford's chromatic adaptation (as in ICC.1:2010, annex E).
glm::dmat3 adapt(glm::dvec2 from, glm::dvec2 to) {
    const glm::dmat3 cone =
        glm::transpose(glm::dmat3(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296));
    const glm::dvec3 scale = (cone * xyz_of(to)) / (cone * xyz_of(from));
    return glm::inverse(cone) * glm::dmat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z) * cone;
}

// The integral of the spectrum's product with the colour-matching functions, 1 nm steps.
glm::dvec3 integrate_xyz(const std::function<float(float)>& spectrum) {
    glm::dvec3 xyz(0.0);
    for (float wavelength = kFirstWavelength; wavelength <= kLastWavelength; wavelength += 1.0f)
        xyz += glm::dvec3(cie_xyz(wavelength)) * double(spectrum(wavelength));
    return xyz;
}

}  // namespace

float SampledSpectrum::at(float wavelength) const {
    if (wavelengths.empty() || wavelength < wavelengths.front() || wavelength > wavelengths.back()) return 0.0f;
    const size_t next =
        size_t(std::upper_bound(wavelengths.begin(), wavelengths.end(), wavelength) - wavelengths.begin());
    if (next == wavelengths.size()) return values.back();
    if (next == 0) return values.front();
    const float t = (wavelength - wavelengths[next - 1]) / (wavelengths[next] - wavelengths[next - 1]);
    return (1.0f - t) * values[next - 1] + t * values[next];
}

std::string SampledSpectrum::bytes() const {
    std::string all = std::to_string(values.size()) + ":";
    for (const std::vector<float>* numbers : {&wavelengths, &values})
        all.append(reinterpret_cast<const char*>(numbers->data()), numbers->size() * sizeof(float));
    return all;
}

glm::vec3 rec709_from_xyz(glm::vec3 xyz) {
    static const glm::dmat3 matrix = glm::inverse(xyz_from_rgb(kRec709));
    return glm::vec3(matrix * glm::dvec3(xyz));
}

float blackbody(float wavelength, float kelvin) {
    // Planck 1901; the constants are exact in the SI of 2019. The maximum follows from Wien's displacement law.
    constexpr double kC1 = 2.0 * 6.62607015e-34 * 299792458.0 * 299792458.0;
    constexpr double kC2 = 6.62607015e-34 * 299792458.0 / 1.380649e-23;
    if (!(kelvin > 0.0f)) return 0.0f;
    const auto planck = [&](double metres) {
        return kC1 / (std::pow(metres, 5.0) * std::expm1(kC2 / (metres * double(kelvin))));
    };
    return float(planck(double(wavelength) * 1e-9) / planck(2.8977721e-3 / double(kelvin)));
}

glm::vec3 light_rgb(const std::function<float(float)>& spectrum) {
    const glm::dvec3 xyz = integrate_xyz(spectrum);
    return xyz.y > 0.0 ? rec709_from_xyz(glm::vec3(xyz / xyz.y)) : glm::vec3(0.0f);
}

glm::vec3 reflectance_rgb(const std::function<float(float)>& spectrum) {
    const auto rgb_under_d65 = [](const std::function<float(float)>& reflectance) {
        return rec709_from_xyz(glm::vec3(integrate_xyz([&](float w) { return reflectance(w) * illuminant_d65(w); })));
    };
    // Divided by white's own colour, because the table's D65 and Rec.709's white differ in the fourth digit.
    static const glm::vec3 white = rgb_under_d65([](float) { return 1.0f; });
    return rgb_under_d65(spectrum) / white;
}

glm::vec3 rec709_from(std::string_view color_space, glm::vec3 rgb, SpectrumUse use) {
    if (color_space == "srgb") return rgb;
    const Primaries& primaries = color_space == "rec2020" ? kRec2020 : color_space == "dci-p3" ? kDciP3 : kAces;
    glm::dvec3 xyz = xyz_from_rgb(primaries) * glm::dvec3(rgb);
    if (use != SpectrumUse::kLight) xyz = adapt(primaries.white, kRec709.white) * xyz;
    return rec709_from_xyz(glm::vec3(xyz));
}

}  // namespace lampyris

#include "core/scene/spectrum.h"

#include "core/image/primaries.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>

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

// The integral of the spectrum's product with the colour-matching functions by the trapezoidal rule: steps of 1 nm, divided at
// `nodes`, where a spectrum bends, so that no line falls between them. Both ends count whole; next to nothing is seen there.
glm::dvec3 integrate_xyz(const SpectralFunction& spectrum, std::span<const float> nodes = {}) {
    std::vector<float> steps, all;
    for (float wavelength = kFirstWavelength; wavelength <= kLastWavelength; wavelength += 1.0f)
        steps.push_back(wavelength);
    const auto first = std::upper_bound(nodes.begin(), nodes.end(), kFirstWavelength),
               last = std::lower_bound(first, nodes.end(), kLastWavelength);
    std::set_union(steps.begin(), steps.end(), first, last, std::back_inserter(all));
    glm::dvec3 xyz(0.0);
    for (size_t i = 0; i < all.size(); ++i) {
        const float low = i > 0 ? all[i - 1] : all[i] - 1.0f, high = i + 1 < all.size() ? all[i + 1] : all[i] + 1.0f;
        xyz += glm::dvec3(cie_xyz(all[i])) * double(spectrum(all[i])) * (0.5 * (double(high) - double(low)));
    }
    return xyz;
}

// The logarithm of Planck's law (1901), up to a constant: its value leaves the range of numbers for cold bodies. The constants
// are exact in the SI of 2019.
double log_planck(double nanometres, double kelvin) {
    constexpr double kC2 = 1e9 * 6.62607015e-34 * 299792458.0 / 1.380649e-23;
    const double x = kC2 / (nanometres * kelvin);
    return -5.0 * std::log(nanometres) - (x > 40.0 ? x : std::log(std::expm1(x)));
}

// Where it is largest, by Wien's displacement law, nm.
double wien_peak(double kelvin) { return 2.8977721e6 / kelvin; }

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
    return float(std::exp(log_planck(wavelength, kelvin) - log_planck(wien_peak(kelvin), kelvin)));
}

float visible_blackbody(float wavelength, float kelvin) {
    if (wavelength > kLastSeen) return 0.0f;
    const double peak = std::clamp(wien_peak(kelvin), double(kFirstWavelength), double(kLastSeen));
    return float(std::exp(log_planck(wavelength, kelvin) - log_planck(peak, kelvin)));
}

glm::vec3 light_rgb(const SpectralFunction& spectrum, std::span<const float> nodes) {
    const glm::dvec3 xyz = integrate_xyz(spectrum, nodes);
    return xyz.y > 0.0 ? rec709_from_xyz(glm::vec3(xyz / xyz.y)) : glm::vec3(0.0f);
}

glm::vec3 reflectance_rgb(const SpectralFunction& spectrum, std::span<const float> nodes) {
    const auto rgb_under_d65 = [](const SpectralFunction& reflectance, std::span<const float> bends) {
        const auto reflected = [&](float w) { return reflectance(w) * illuminant_d65(w); };
        return rec709_from_xyz(glm::vec3(integrate_xyz(reflected, bends)));
    };
    // Divided by white's own colour, because the table's D65 and Rec.709's white differ in the fourth digit.
    static const glm::vec3 white = rgb_under_d65([](float) { return 1.0f; }, {});
    return rgb_under_d65(spectrum, nodes) / white;
}

glm::vec3 rec709_from(std::string_view color_space, glm::vec3 rgb, SpectrumUse use) {
    if (color_space == "srgb") return rgb;
    const Primaries& primaries = color_space == "rec2020" ? kRec2020 : color_space == "dci-p3" ? kDciP3 : kAces;
    glm::dvec3 xyz = xyz_from_rgb(primaries) * glm::dvec3(rgb);
    if (use != SpectrumUse::kLight) xyz = adapt(primaries.white, kRec709.white) * xyz;
    return rec709_from_xyz(glm::vec3(xyz));
}

}  // namespace lampyris

// The spectra that pbrt-v4 knows by name, and the colour of metals.
#include "core/scene/spectrum.h"

#include "core/base/memo.h"
#include "core/scene/spectrum_metals.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <map>

namespace lampyris {

namespace {

// Sellmeier's equation with Schott's coefficients (Schott optical glass data sheets 2017); wavelengths in micrometres.
struct Glass {
    const char* name;
    const char* other_name;  // pbrt-v4's, where it leaves out the S
    double b[3], c[3];
};
constexpr Glass kGlasses[] = {
    {"glass-BK7", nullptr, {1.03961212, 0.231792344, 1.01046945}, {0.00600069867, 0.0200179144, 103.560653}},
    {"glass-BAF10", nullptr, {1.5851495, 0.143559385, 1.08521269}, {0.00926681282, 0.0424489805, 105.613573}},
    {"glass-FK51A", nullptr, {0.971247817, 0.216901417, 0.904651666}, {0.00472301995, 0.0153575612, 168.68133}},
    {"glass-LASF9", nullptr, {2.00029547, 0.298926886, 1.80691843}, {0.0121426017, 0.0538736236, 156.530829}},
    {"glass-SF5", "glass-F5", {1.52481889, 0.187085527, 1.42729015}, {0.011254756, 0.0588995392, 129.141675}},
    {"glass-SF10", "glass-F10", {1.62153902, 0.256287842, 1.64447552}, {0.0122241457, 0.0595736775, 147.468793}},
    {"glass-SF11", "glass-F11", {1.73759695, 0.313747346, 1.89878101}, {0.013188707, 0.0623068142, 155.23629}},
};

SampledSpectrum tabulate(float step, const std::function<float(float)>& at) {
    SampledSpectrum spectrum;
    for (float w = kFirstWavelength; w <= kLastWavelength; w += step) {
        spectrum.wavelengths.push_back(w);
        spectrum.values.push_back(at(w));
    }
    return spectrum;
}

SampledSpectrum glass_spectrum(const Glass& glass) {
    return tabulate(5.0f, [&](float wavelength) {
        const double l2 = double(wavelength) * wavelength * 1e-6;
        double n2 = 1.0;
        for (int i = 0; i < 3; ++i) n2 += glass.b[i] * l2 / (l2 - glass.c[i]);
        return float(std::sqrt(n2));
    });
}

using Table = std::map<std::string, SampledSpectrum, std::less<>>;

Table make_table() {
    Table table;
    for (const Metal& metal : metals()) {
        SampledSpectrum eta, k;
        for (size_t i = 0; i < metal.n.size(); ++i) {
            const float wavelength = kMetalFirst + kMetalStep * float(i);
            eta.wavelengths.push_back(wavelength), k.wavelengths.push_back(wavelength);
            eta.values.push_back(metal.n[i]), k.values.push_back(metal.k[i]);
        }
        table.emplace(std::string("metal-") + metal.name + "-eta", std::move(eta));
        table.emplace(std::string("metal-") + metal.name + "-k", std::move(k));
    }
    for (const Glass& glass : kGlasses) {
        table.emplace(glass.name, glass_spectrum(glass));
        if (glass.other_name) table.emplace(glass.other_name, glass_spectrum(glass));
    }
    // CIE 15:2004: illuminant A is a black body of 2856 K (by the temperature scale of 1968).
    table.emplace("stdillum-A", tabulate(5.0f, [](float w) { return blackbody(w, 2855.5f); }));
    table.emplace("stdillum-D65", tabulate(5.0f, illuminant_d65));
    return table;
}

const Table& named() {
    static const Table table = make_table();
    return table;
}

}  // namespace

const SampledSpectrum* named_spectrum(std::string_view name) {
    const auto found = named().find(name);
    return found == named().end() ? nullptr : &found->second;
}

std::vector<std::string> named_spectra() {
    std::vector<std::string> names;
    for (const auto& [name, spectrum] : named()) names.push_back(name);
    return names;
}

namespace {

// A metal per channel. The visible property of a metal is its reflectance, so the reflectance at normal incidence is computed
// for every wavelength and converted to a colour, R. eta is the mean under the positive part of the channel's sensitivity to
// white light, and k follows from R = ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2). So at normal incidence the colour is that of
// the spectrum (as far as Rec.709 and R < 1 can show it), and at grazing angles it still goes to white.
ConductorRgb integrate_conductor(const SampledSpectrum& eta, const SampledSpectrum& k) {
    const auto held = [](const SampledSpectrum& spectrum, float w) {  // the values at its ends continue beyond them
        return spectrum.at(std::clamp(w, spectrum.wavelengths.front(), spectrum.wavelengths.back()));
    };
    const auto reflectance = [&](float w) {
        const float n = held(eta, w), a = held(k, w);
        return ((n - 1.0f) * (n - 1.0f) + a * a) / ((n + 1.0f) * (n + 1.0f) + a * a);
    };
    const glm::vec3 colour = glm::clamp(reflectance_rgb(reflectance), glm::vec3(0.0f), glm::vec3(0.9999f));
    glm::dvec3 sum(0.0), weight(0.0);
    for (float w = kFirstWavelength; w <= kLastWavelength; w += 1.0f) {
        const glm::dvec3 sensitivity =
            glm::max(glm::dvec3(rec709_from_xyz(cie_xyz(w) * illuminant_d65(w))), glm::dvec3(0.0));
        sum += sensitivity * double(held(eta, w));
        weight += sensitivity;
    }
    ConductorRgb rgb{glm::vec3(sum / weight), glm::vec3(0.0f)};
    for (int c = 0; c < 3; ++c) {
        const double r = colour[c];
        const double lowest = (double(rgb.eta[c]) - 1.0) / (double(rgb.eta[c]) + 1.0);
        // If even k = 0 reflects more than R, eta alone determines R.
        if (lowest * lowest >= r) {
            const double root = std::sqrt(r);
            rgb.eta[c] = float(rgb.eta[c] >= 1.0f ? (1.0 + root) / (1.0 - root) : (1.0 - root) / (1.0 + root));
            continue;
        }
        const double n = rgb.eta[c];
        rgb.k[c] = float(std::sqrt((r * (n + 1.0) * (n + 1.0) - (n - 1.0) * (n - 1.0)) / (1.0 - r)));
    }
    return rgb;
}

}  // namespace

// An exporter writes the same metal for each of its objects.
ConductorRgb conductor_rgb(const SampledSpectrum& eta, const SampledSpectrum& k) {
    static Memo<std::string, ConductorRgb> memo(256);
    return memo.get(eta.bytes() + k.bytes(), [&] { return integrate_conductor(eta, k); });
}

}  // namespace lampyris

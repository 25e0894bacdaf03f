// Parameters of type rgb, blackbody and spectrum as linear Rec.709.
#include "core/scene/spectrum.h"

#include "core/base/memo.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace lampyris {

namespace {

Location place_of(const Parameter& parameter) {
    return parameter.value_location.known() ? parameter.value_location : parameter.location;
}

// Pairs of wavelength and value; wavelengths must increase.
std::optional<SampledSpectrum> from_pairs(const std::vector<float>& pairs, Location where, const std::string& what,
                                          Diagnostics& diagnostics) {
    if (pairs.empty() || pairs.size() % 2 != 0) {
        diagnostics.error(where, fmt::format("{} has {} numbers", what, pairs.size()),
                          "pairs of wavelength (nm) and value");
        return {};
    }
    SampledSpectrum spectrum;
    for (size_t i = 0; i < pairs.size(); i += 2) {
        if (!std::isfinite(pairs[i]) || !std::isfinite(pairs[i + 1])) {
            diagnostics.error(where, fmt::format("{} has a number that is not finite", what));
            return {};
        }
        if (i > 0 && pairs[i] <= pairs[i - 2]) {
            diagnostics.error(where, fmt::format("{}: wavelength {:g} follows {:g}", what, pairs[i], pairs[i - 2]),
                              "wavelengths must rise");
            return {};
        }
        spectrum.wavelengths.push_back(pairs[i]);
        spectrum.values.push_back(pairs[i + 1]);
    }
    return spectrum;
}

// A text file of numbers, alternating wavelength and value; '#' starts a comment.
std::optional<SampledSpectrum> from_file(const std::string& path, Location where, Diagnostics& diagnostics) {
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    std::vector<float> numbers;
    for (size_t i = 0; i < text.size();) {
        const char c = text[i];
        if (c == '#') {
            i = std::min(text.find('\n', i), text.size());
        } else if (c == ' ' || c == '\t' || c == '\n' || c == '\r') {
            ++i;
        } else {
            float number = 0.0f;
            const auto [end, code] = std::from_chars(text.data() + i, text.data() + text.size(), number);
            if (code != std::errc()) {
                diagnostics.error(where, fmt::format("spectrum file {}: not a number at byte {}", path, i));
                return {};
            }
            numbers.push_back(number);
            i = size_t(end - text.data());
        }
    }
    return from_pairs(numbers, where, "spectrum file " + path, diagnostics);
}

std::optional<glm::vec3> rgb_value(const Parameter& parameter, SpectrumUse use, Diagnostics& diagnostics) {
    const auto* numbers = std::get_if<std::vector<float>>(&parameter.values);
    if (!numbers || numbers->size() != 3) {
        diagnostics.error(place_of(parameter),
                          fmt::format("\"{}\" has {} numbers", parameter.name, numbers ? numbers->size() : 0),
                          "an rgb has 3");
        return {};
    }
    const glm::vec3 rgb((*numbers)[0], (*numbers)[1], (*numbers)[2]);
    for (int c = 0; c < 3; ++c) {
        if (std::isfinite(rgb[c]) && rgb[c] >= 0.0f && (use != SpectrumUse::kAlbedo || rgb[c] <= 1.0f)) continue;
        diagnostics.error(place_of(parameter), fmt::format("\"{}\" has the component {:g}", parameter.name, rgb[c]),
                          use == SpectrumUse::kAlbedo ? "a reflectance is between 0 and 1" : "it must be at least 0");
        return {};
    }
    return glm::max(rec709_from(parameter.color_space, rgb, use), glm::vec3(0.0f));
}

// A scene repeats few spectra many times.
constexpr size_t kRemembered = 256;

SampledSpectrum blackbody_spectrum(float kelvin, float (*planck)(float wavelength, float kelvin)) {
    static Memo<std::pair<float, bool>, SampledSpectrum> memo(kRemembered);
    return memo.get({kelvin, planck == blackbody}, [&] {
        SampledSpectrum spectrum;
        for (float w = kFirstWavelength; w <= kLastWavelength; w += 5.0f) {
            spectrum.wavelengths.push_back(w);
            spectrum.values.push_back(planck(w, kelvin));
        }
        return spectrum;
    });
}

glm::vec3 rgb_of_spectrum(const SampledSpectrum& spectrum, bool light) {
    static Memo<std::string, glm::vec3> memo(kRemembered);
    const auto at = [&](float wavelength) { return spectrum.at(wavelength); };
    // Colours are at most slightly outside of Rec.709's gamut; negative components become zero.
    return memo.get((light ? 'l' : 'r') + spectrum.bytes(), [&] {
        const glm::vec3 rgb = light ? light_rgb(at, spectrum.wavelengths) : reflectance_rgb(at, spectrum.wavelengths);
        return glm::max(rgb, glm::vec3(0.0f));
    });
}

std::optional<SampledSpectrum> given_spectrum(const Parameter& parameter, SpectrumUse use, const SceneFolder& folder,
                                              Diagnostics& diagnostics) {
    const Location where = place_of(parameter);
    if (const auto* numbers = std::get_if<std::vector<float>>(&parameter.values)) {
        if (parameter.type == ParameterType::kBlackbody) {
            if (numbers->size() != 1 || !((*numbers)[0] > 0.0f) || !std::isfinite((*numbers)[0])) {
                diagnostics.error(where, fmt::format("\"{}\" must be one temperature above 0 K", parameter.name));
                return {};
            }
            // A light is scaled to a luminance of one: all that counts is what is seen of it.
            return blackbody_spectrum((*numbers)[0], use == SpectrumUse::kLight ? visible_blackbody : blackbody);
        }
        return from_pairs(*numbers, where, fmt::format("spectrum \"{}\"", parameter.name), diagnostics);
    }
    const auto* names = std::get_if<std::vector<std::string>>(&parameter.values);
    if (!names || names->size() != 1) {
        diagnostics.error(where, fmt::format("spectrum \"{}\" must be one name, or pairs of numbers", parameter.name));
        return {};
    }
    if (const SampledSpectrum* named = named_spectrum(names->front())) return *named;
    const std::string path = folder.path(names->front());
    const std::string refused = folder.why_refused(path);
    std::error_code code;
    if (refused.empty() && std::filesystem::is_regular_file(path, code)) return from_file(path, where, diagnostics);
    const std::string near = did_you_mean(names->front(), named_spectra());
    diagnostics.error(where,
                      fmt::format("\"{}\" is neither a named spectrum nor a file{}{}", shown(names->front()),
                                  refused.empty() ? "" : " that may be read: ", refused),
                      fmt::format("{}{}named spectra: {}", near, near.empty() ? "" : "; ", list_of(named_spectra())));
    return {};
}

}  // namespace

std::optional<SampledSpectrum> sampled_spectrum(const Parameter& parameter, SpectrumUse use, const SceneFolder& folder,
                                                Diagnostics& diagnostics) {
    std::optional<SampledSpectrum> spectrum = given_spectrum(parameter, use, folder, diagnostics);
    if (!spectrum) return {};
    const auto negative =
        std::count_if(spectrum->values.begin(), spectrum->values.end(), [](float v) { return v < 0.0f; });
    if (negative > 0) {
        diagnostics.warning(place_of(parameter),
                            fmt::format("spectrum \"{}\" holds {} negative values", parameter.name, negative),
                            "they are taken for 0");
        for (float& value : spectrum->values) value = std::max(value, 0.0f);
    }
    return spectrum;
}

std::optional<glm::vec3> spectrum_rgb(const Parameter& parameter, SpectrumUse use, const SceneFolder& folder,
                                      Diagnostics& diagnostics) {
    if (parameter.type == ParameterType::kRgb) return rgb_value(parameter, use, diagnostics);
    if (parameter.type != ParameterType::kSpectrum && parameter.type != ParameterType::kBlackbody) {
        diagnostics.error(parameter.location,
                          fmt::format("\"{}\" is of type {}", parameter.name, type_name(parameter.type)),
                          "rgb, blackbody or spectrum");
        return {};
    }
    const std::optional<SampledSpectrum> spectrum = sampled_spectrum(parameter, use, folder, diagnostics);
    if (!spectrum) return {};
    const glm::vec3 rgb = rgb_of_spectrum(*spectrum, use == SpectrumUse::kLight);
    const bool emits = std::any_of(spectrum->values.begin(), spectrum->values.end(), [](float v) { return v > 0.0f; });
    if (use == SpectrumUse::kLight && emits && rgb == glm::vec3(0.0f))
        diagnostics.warning(place_of(parameter),
                            fmt::format("spectrum \"{}\" has no light that is seen", parameter.name),
                            fmt::format("light from {:g} to {:g} nm is", kFirstWavelength, kLastSeen));
    return use == SpectrumUse::kAlbedo ? glm::min(rgb, glm::vec3(1.0f)) : rgb;
}

}  // namespace lampyris

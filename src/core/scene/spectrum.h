// Spectra of the scene file -> linear Rec.709, the only colour that kernels know.
//
// pbrt-v4 renders spectrally and converts at the film; here each spectrum is converted when it is read. A light's spectrum is
// weighted by the CIE 1931 observer. A reflectance is seen under D65 (which is pbrt-v4's illuminant for rgb lights), so that a
// reflectance of one is white. docs/decisions explains what this approximates.
#pragma once

#include "core/base/error.h"
#include "core/device/kernel_types.h"
#include "core/scene/description.h"

#include <glm/vec3.hpp>

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

enum class SpectrumUse {
    kAlbedo,     // a reflectance: 0 to 1
    kUnbounded,  // an index of refraction, an absorption, ...
    kLight,      // rgb keeps its value, anything else is scaled to a luminance of one, as pbrt-v4 does
};

// A spectrum as a piecewise linear function of the wavelength in nm; zero outside of its samples.
struct SampledSpectrum {
    std::vector<float> wavelengths, values;
    float at(float wavelength) const;
    // All of it, as a key: unlike floats, bytes are equal to themselves whatever they mean.
    std::string bytes() const;
};

inline constexpr float kFirstWavelength = 360.0f, kLastWavelength = 830.0f;
// The last one that the tabulated observer sees.
inline constexpr float kLastSeen = 780.0f;

// CIE 1931 2-degree colour-matching functions and the standard illuminant D65, at a wavelength in nm.
glm::vec3 cie_xyz(float wavelength);
float illuminant_d65(float wavelength);
glm::vec3 rec709_from_xyz(glm::vec3 xyz);
// Planck's law for a temperature above 0, relative: 1 at its maximum, as pbrt-v4 normalizes "blackbody".
float blackbody(float wavelength, float kelvin);
// The same, 1 at the maximum of what is seen, and 0 beyond: a float's range is enough for any temperature.
float visible_blackbody(float wavelength, float kelvin);
// A function of the wavelength (nm).
using SpectralFunction = std::function<float(float)>;
// Linear Rec.709: as emission, with luminance one, or black if nothing of it is seen; as a reflectance under D65. `nodes` (rising,
// nm): where it bends.
glm::vec3 light_rgb(const SpectralFunction& spectrum, std::span<const float> nodes = {});
glm::vec3 reflectance_rgb(const SpectralFunction& spectrum, std::span<const float> nodes = {});
// Linear Rec.709 of an rgb in one of pbrt-v4's colour spaces. Reflectances are adapted from white to white, lights keep
// their chromaticity.
glm::vec3 rec709_from(std::string_view color_space, glm::vec3 rgb, SpectrumUse use);

// The spectra that pbrt-v4 knows by name; empty for an unknown name.
const SampledSpectrum* named_spectrum(std::string_view name);
std::vector<std::string> named_spectra();

// The complex index of refraction of a metal per channel, so that its Fresnel reflectance per channel follows the
// spectral one: see spectrum_named.cpp.
struct ConductorRgb {
    glm::vec3 eta, k;
};
ConductorRgb conductor_rgb(const SampledSpectrum& eta, const SampledSpectrum& k);

// A parameter of type blackbody, spectrum or float as a sampled spectrum; empty for rgb. Errors (unknown name, unreadable file,
// unordered wavelengths) are reported; negative values become 0, with a warning.
std::optional<SampledSpectrum> sampled_spectrum(const Parameter& parameter, SpectrumUse use, const SceneFolder& folder,
                                                Diagnostics& diagnostics);
// Any spectrum parameter as linear Rec.709; empty, with the error reported, if it is wrong.
std::optional<glm::vec3> spectrum_rgb(const Parameter& parameter, SpectrumUse use, const SceneFolder& folder,
                                      Diagnostics& diagnostics);

}  // namespace lampyris

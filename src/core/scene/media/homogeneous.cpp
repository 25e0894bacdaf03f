// Medium "homogeneous", the same everywhere. Absorption is simulated; scattering and emission are refused.
#include "core/scene/builder.h"

#include <glm/glm.hpp>

#include <cmath>

namespace lampyris {

namespace {

constexpr const char* kHint = "\"rgb sigma_s\" [ 0 0 0 ] makes one that only absorbs";

void build(MediumContext& context) {
    ParameterReader& reader = context.reader;
    const auto spectrum = [&](const char* name, SpectrumUse use, float absent) {
        return read_spectrum(context.build, reader, name, use, Spectrum(reader.has(name) ? 0.0f : absent));
    };
    const float scale = reader.get_float("scale");
    const Spectrum absorption = scale * spectrum("sigma_a", SpectrumUse::kUnbounded, 1.0f);
    const Spectrum scattering = scale * spectrum("sigma_s", SpectrumUse::kUnbounded, 1.0f);
    const Spectrum emission = reader.get_float("Lescale") * spectrum("Le", SpectrumUse::kLight, 0.0f);
    reader.get_float("g");
    const bool is_preset = !reader.get_string("preset").empty();
    context.record.sigma_a = absorption;
    if (!std::isfinite(absorption[0] + absorption[1] + absorption[2]))
        reader.error("sigma_a", "\"sigma_a\" times \"scale\" is not finite", "smaller numbers");
    if (is_preset) {
        context.refuse("preset", "which scatters as all presets do", kHint);
    } else if (scattering != Spectrum(0.0f)) {
        context.refuse("sigma_s", reader.has("sigma_s") ? "which scatters" : "which scatters (\"sigma_s\" is 1)",
                       kHint);
    } else if (emission != Spectrum(0.0f)) {
        context.refuse("Le", "which emits", "without \"Le\" it only absorbs");
    }
}

ParameterSpecs specs() {
    return {value("sigma_a", ParameterType::kSpectrum, "1", "absorption").in("1 / scene unit"),
            value("sigma_s", ParameterType::kSpectrum, "1", "scattering: only 0 is supported").in("1 / scene unit"),
            real("scale", 1.0, "multiplies both").at_least(0),
            text("preset", "", "pbrt-v4's measured media, by name; they scatter: not supported"),
            real("g", 0.0, "asymmetry of the scattering; without scattering, it has no effect").between(-1, 1),
            value("Le", ParameterType::kSpectrum, "0", "emission: only 0 is supported"),
            real("Lescale", 1.0, "multiplies it").at_least(0)};
}

const RegisterMedium homogeneous("homogeneous", "The same everywhere; absorbs.", specs(), build);

}  // namespace

}  // namespace lampyris

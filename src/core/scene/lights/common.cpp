#include "core/scene/lights/common.h"

#include <glm/glm.hpp>

namespace lampyris {

double luminance_of(glm::dvec3 rgb) { return glm::dot(rgb, glm::dvec3(0.2126, 0.7152, 0.0722)); }
double luminance_of(Spectrum s) { return luminance_of(glm::dvec3(rgb_of(s))); }

kernel::LightRecord blank_light(uint32_t kind) {
    kernel::LightRecord record{};
    record.kind = kind;
    record.image = record.transform = kernel::NONE;
    return record;
}

glm::vec3 transformed_point(const glm::mat4& m, glm::vec3 p) { return glm::vec3(m * glm::vec4(p, 1.0f)); }

Spectrum read_emission(LightContext& context, std::string_view name) {
    const float scale = context.reader.get_float("scale");
    return scale * read_spectrum(context.build, context.reader, name, SpectrumUse::kLight, Spectrum(1.0f));
}

glm::vec3 read_direction(LightContext& context, glm::vec3& from) {
    const auto point = [&](const char* name, glm::vec3 absent) {
        const std::vector<float> p = context.reader.get_tuple(name, 3);
        return p.size() == 3 ? glm::vec3(p[0], p[1], p[2]) : absent;
    };
    from = point("from", glm::vec3(0.0f));
    const glm::vec3 direction = point("to", glm::vec3(0.0f, 0.0f, 1.0f)) - from;
    if (glm::dot(direction, direction) > 0.0f) return glm::normalize(direction);
    context.reader.error("to", "\"from\" and \"to\" are the same point", "they give the direction");
    return {0.0f, 0.0f, 1.0f};
}

ParameterSpec emission_spec(const std::string& name, const std::string& of_what) {
    return value(name, ParameterType::kSpectrum, "1 1 1",
                 of_what + "; a spectrum other than rgb is scaled to luminance 1");
}
ParameterSpec scale_spec() { return real("scale", 1.0, "multiplies it").at_least(0); }
ParameterSpec power_spec() {
    return real("power", 0.0, "luminous power; 0: given by the other parameters; as in pbrt-v4, rgb values multiply it")
        .at_least(0);
}

}  // namespace lampyris

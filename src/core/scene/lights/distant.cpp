// Light "distant": the sun.
#include "core/scene/lights/common.h"

#include <glm/glm.hpp>

#include <numbers>

namespace lampyris {

namespace {

void build(LightContext& context) {
    kernel::LightRecord record = blank_light(kernel::LIGHT_DISTANT);
    glm::vec3 from;
    const glm::vec3 direction = read_direction(context, from);
    const glm::mat3 m(context.light.world_from_light.matrix[0]);
    record.p0 = -glm::normalize(m * direction);
    Spectrum irradiance = read_emission(context, "L");
    if (const float illuminance = context.reader.get_float("illuminance"); illuminance > 0.0f)
        irradiance *= illuminance;
    record.emission = irradiance;
    context.ask(kernel::EFFECT_DISTANT_LIGHTS);
    context.build.distant_lights.push_back(
        {record, luminance_of(irradiance) * std::numbers::pi, true, context.light.location});
}

const RegisterLight distant(
    "distant", "Parallel light from one direction.",
    {emission_spec("L", "irradiance across the light's direction"), scale_spec(),
     real("illuminance", 0.0, "across the light's direction; 0: given by the other parameters").at_least(0),
     value("from", ParameterType::kPoint3, "0 0 0", "the light comes from this side"),
     value("to", ParameterType::kPoint3, "0 0 1", "and goes to this one")},
    build);

}  // namespace

}  // namespace lampyris

// Lights "point" and "spot".
#include "core/scene/lights/common.h"

#include <glm/glm.hpp>

#include <cmath>
#include <numbers>

namespace lampyris {

namespace {

constexpr double kPi = std::numbers::pi;

// 1 - cos of an angle in degrees.
double one_minus_cos(double degrees) { return 2.0 * std::pow(std::sin(degrees * kPi / 360.0), 2); }

// `sphere` is the power that a unit intensity emits in total, in sr.
void add_light(LightContext& context, kernel::LightRecord record, Spectrum intensity, double sphere) {
    if (const float power = context.reader.get_float("power"); power > 0.0f) intensity *= float(power / sphere);
    record.emission = intensity;
    context.ask(kernel::EFFECT_POINT_LIGHTS);
    context.build.lights.push_back({record, luminance_of(intensity) * sphere, false, context.light.location});
}

void build_point(LightContext& context) {
    kernel::LightRecord record = blank_light(kernel::LIGHT_POINT);
    const std::vector<float> from = context.reader.get_tuple("from", 3);
    const glm::vec3 p = from.size() == 3 ? glm::vec3(from[0], from[1], from[2]) : glm::vec3(0.0f);
    record.p0 = transformed_point(context.light.world_from_light.matrix[0], p);
    add_light(context, record, read_emission(context, "I"), 4.0 * kPi);
}

void build_spot(LightContext& context) {
    kernel::LightRecord record = blank_light(kernel::LIGHT_SPOT);
    const float cone = context.reader.get_float("coneangle"), delta = context.reader.get_float("conedeltaangle");
    if (delta > cone)
        context.reader.error("conedeltaangle", "\"conedeltaangle\" is larger than \"coneangle\"",
                             "the falloff is a part of the cone");
    const double begin = one_minus_cos(std::fmax(double(cone) - double(delta), 0.0)), end = one_minus_cos(cone);
    glm::vec3 from;
    const glm::vec3 direction = read_direction(context, from);
    const glm::mat4& m = context.light.world_from_light.matrix[0];
    const glm::vec3 axis = glm::mat3(m) * direction;
    record.p0 = transformed_point(m, from);
    set_spot(record, glm::normalize(axis), float(begin), float(end));
    // pbrt-v4, lights.cpp, SpotLight::Create: the falloff counts as half.
    add_light(context, record, read_emission(context, "I"), 2.0 * kPi * (begin + (end - begin) / 2.0));
}

ParameterSpecs point_specs() {
    return {emission_spec("I", "intensity"), scale_spec(), power_spec(),
            value("from", ParameterType::kPoint3, "0 0 0", "position").in("scene units")};
}
ParameterSpecs spot_specs() {
    ParameterSpecs specs = point_specs();
    specs.push_back(value("to", ParameterType::kPoint3, "0 0 1", "a point on the axis").in("scene units"));
    specs.push_back(
        real("coneangle", 30.0, "angle from the axis at which the light ends").above(0).between(0, 180).in("degrees"));
    specs.push_back(real("conedeltaangle", 5.0, "angle over which the light falls off, inside of the cone")
                        .between(0, 180)
                        .in("degrees"));
    return specs;
}

const RegisterLight point("point", "Sends the same intensity in all directions from a point.", point_specs(),
                          build_point);
const RegisterLight spot("spot", "A cone of light from a point.", spot_specs(), build_spot);

}  // namespace

}  // namespace lampyris

// What several lights share.
#pragma once

#include "core/scene/builder.h"

#include <glm/mat4x4.hpp>

namespace lampyris {

double luminance_of(glm::dvec3 rgb);  // Rec.709
double luminance_of(Spectrum s);
kernel::LightRecord blank_light(uint32_t kind);
// What core/kernel/light_record.h reads. `p0` is the position, or a distant light's direction.
// `begin` and `end`: 1 - cos of the angles at which the falloff begins and ends.
inline void set_spot(kernel::LightRecord& record, const glm::vec3& axis, float begin, float end) {
    record.p1 = axis, record.extent = begin, record.inverse_area = end;
}
inline void set_projection_window(kernel::LightRecord& record, const glm::vec4& window) {
    record.p2 = glm::vec3(window), record.inverse_area = window.w;
}
glm::vec3 transformed_point(const glm::mat4& m, glm::vec3 p);
// The light's intensity "I" (or "L"), times "scale".
Spectrum read_emission(LightContext& context, std::string_view name);
// The direction of the light, from the point "from" to the point "to". Reports an error if they coincide.
glm::vec3 read_direction(LightContext& context, glm::vec3& from);
ParameterSpec emission_spec(const std::string& name, const std::string& of_what);
ParameterSpec scale_spec();
ParameterSpec power_spec();

}  // namespace lampyris

// Emissive shapes: AreaLightSource directives, and the light records of the shapes that they apply to.
#pragma once

#include "core/scene/builder.h"

namespace lampyris {

struct AreaLightContext {
    BuildContext& build;
    Entity& entity;
    ParameterReader& reader;
    AreaLight& light;
};
using AreaLightFactory = void (*)(AreaLightContext&);
Registry<AreaLightFactory>& area_light_registry();
struct RegisterAreaLight {
    RegisterAreaLight(const char* name, const char* summary, ParameterSpecs specs, AreaLightFactory factory);
};

// What an AreaLightSource directive says.
AreaLight read_area_light(BuildContext& context, Entity& entity);

// A triangle's light: kind, corners, and what is derived from them (layout.h).
kernel::LightRecord triangle_light(const glm::vec3& p0, const glm::vec3& p1, const glm::vec3& p2,
                                   uint32_t geometry_flags);

// The lights of a geometry's primitives: called once, and then add_area_light for each primitive in order.
void begin_area_lights(ShapeContext& context, uint32_t geometry, uint32_t primitive_count);
// `area` is the primitive's in world space; `nominal_area` the one by which pbrt-v4 turns "power" into radiance (that of
// the shape before its transform, for quadrics).
void add_area_light(ShapeContext& context, kernel::LightRecord record, uint32_t geometry, uint32_t primitive,
                    float area, float nominal_area);

}  // namespace lampyris

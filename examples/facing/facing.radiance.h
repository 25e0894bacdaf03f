// Facing ratio: how squarely each surface faces the viewer, cos(angle between normal and view ray) ^ power.
#include "core/kernel/radiance.h"
#include "facing/facing.params.h"

BUFFER_RO(1, FacingParams, params)

FN vec3 radiance_along(IN(Ray) ray, INOUT(Sampler) numbers, INOUT(FirstHit) first) {
    Surface s;
    if (!intersect_scene(ray, s)) return vec3(0.0f);
    first = first_hit(s, vec3(1.0f), s.distance);
    return vec3(pow_of(abs(dot3(s.ns, ray.direction)), params[0].power));
}

// Facing ratio: how squarely each surface faces the viewer, cos(angle between normal and view ray) ^ power.
#include "core/kernel/radiance.h"
#include "facing/facing_params.h"

BUFFER_RO(1, FacingParams, params)

FN Spectrum radiance_along(IN(Ray) ray, INOUT(Sampler) numbers, INOUT(FirstHit) first) {
    Surface s;
    if (!intersect_scene(ray, s)) return Spectrum(0.0f);
    first = first_hit(s, Spectrum(1.0f), s.distance);
    return Spectrum(pow_of(abs(dot3(s.ns, ray.direction)), params[0].power));
}

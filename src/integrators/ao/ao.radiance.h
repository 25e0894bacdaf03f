// Ambient occlusion: the cosine-weighted fraction of the hemisphere, on the viewer's side, that is visible from a
// point.
#include "core/kernel/radiance.h"

#include "integrators/ao/ao_params.h"

BUFFER_RO(1, AoParams, params)

FN Spectrum radiance_along(IN(Ray) ray, INOUT(Sampler) numbers, INOUT(FirstHit) first) {
    Surface s;
    if (!intersect_scene(ray, s)) return Spectrum(0.0f);
    first = first_hit(s, Spectrum(0.0f), s.distance);
    Frame frame = frame_from_z(face_forward(s.ng, -ray.direction));
    float limit = min(params[0].distance, INFINITE_DISTANCE);
    float seen = 0.0f;
    int k = 0;
    for (; k < params[0].rays; ++k) {
        vec3 direction = to_world(frame, sample_cosine_hemisphere(sample_2d(numbers)));
        seen += scene_openness(s, direction, limit);
    }
    if (k != params[0].rays) REPORT_UNFINISHED();
    return Spectrum(seen / float(params[0].rays));
}

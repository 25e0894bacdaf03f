// Ambient occlusion: the cosine-weighted share of the hemisphere, on the viewer's side, that a point sees.
#include "core/kernel/scene.h"

#include "core/kernel/film.h"
#include "integrators/ao/ao.params.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, AoParams, params)
BUFFER_RW(2, FilmPixel, film)

KERNEL(ao) {
    uvec4 pixels = window[0].pixels;
    uvec4 range = window[0].samples;
    uvec2 local = film_pixel_of(index, pixels);
    uint place = local.y * pixels.z + local.x;
    uint x = pixels.x + local.x;
    uint y = pixels.y + local.y;
    FilmPixel pixel = film[place];
    uint rays = 0u;
    for (uint i = 0u; i < range.y; ++i) {
        Sampler numbers = sampler_begin(y * scene[0].camera.film.x + x, range.x + i, range.z, range.w);
        float weight;
        vec2 offset = pixel_filter_sample(sample_2d(numbers), weight);
        vec2 u_lens = vec2(0.5f);
        if (HAS(EFFECT_DEPTH_OF_FIELD)) u_lens = sample_2d(numbers);
        Ray ray = camera_ray(vec2(float(x) + 0.5f + offset.x, float(y) + 0.5f + offset.y), u_lens);
        float seen = 0.0f;
        Surface s;
        if (intersect_scene(ray.origin, ray.direction, s, rays)) {
            Frame frame = frame_from_z(face_forward(s.ng, -ray.direction));
            for (int k = 0; k < params[0].rays; ++k) {
                vec3 direction = to_world(frame, sample_cosine_hemisphere(sample_2d(numbers)));
                if (!scene_occluded(s.position, s.error, s.ng, direction, min(params[0].distance, INFINITE_DISTANCE), rays)) seen += 1.0f;
            }
            seen = seen / float(params[0].rays);
            pixel.normal += vec4(s.ns.x, s.ns.y, s.ns.z, 0.0f);
            pixel.squares.w += s.distance;
            pixel.albedo.w += 1.0f;
        }
        film_add(pixel, vec3(seen), weight, range.x + i);
    }
    pixel.counts.y += rays;
    film[place] = pixel;
}

// Facing ratio: how squarely each surface faces the viewer, cos(angle between normal and view ray) ^ power.
#include "core/kernel/scene.h"

#include "core/kernel/film.h"
#include "facing/facing.params.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, FacingParams, params)
BUFFER_RW(2, FilmPixel, film)

KERNEL(facing) {
    uvec4 pixels = window[0].pixels;  // the film's window: x, y, width, height
    uvec4 range = window[0].samples;  // first sample, how many, seed, sampler
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
        vec2 u_lens = sample_2d(numbers);
        Ray ray = camera_ray(vec2(float(x) + 0.5f + offset.x, float(y) + 0.5f + offset.y), u_lens);
        float facing = 0.0f;
        Surface s;
        if (intersect_scene(ray.origin, ray.direction, s, rays)) {
            facing = pow_of(abs(dot3(s.ns, ray.direction)), params[0].power);
        }
        film_add(pixel, vec3(facing), weight, range.x + i);
    }
    pixel.counts.y += rays;
    film[place] = pixel;
}

// Facing ratio: how squarely each surface faces the viewer, cos(angle between normal and view ray) ^ power.
#include "core/kernel/scene.h"

#include "core/kernel/film.h"
#include "facing/facing.params.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, FacingParams, params)
BUFFER_RW(2, FilmPixel, film)

KERNEL(facing) {
    FilmWindow w = window[0];
    uvec2 local = film_pixel_of(index, w.pixels);
    uint place = local.y * w.pixels.z + local.x;
    FilmPixel pixel = film[place];
    uint rays = 0u;
    for (uint i = 0u; i < w.samples.y; ++i) {
        CameraSample camera = camera_sample(w, local, i);
        float facing = 0.0f;
        Surface s;
        if (intersect_scene(camera.ray.origin, camera.ray.direction, s, rays)) {
            facing = pow_of(abs(dot3(s.ns, camera.ray.direction)), params[0].power);
        }
        film_add(pixel, vec3(facing), camera.weight, camera.pass);
    }
    pixel.counts.y += rays;
    film[place] = pixel;
}

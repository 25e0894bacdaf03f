// Ambient occlusion: the cosine-weighted share of the hemisphere, on the viewer's side, that a point sees.
#include "core/kernel/scene.h"

#include "core/kernel/film.h"
#include "integrators/ao/ao.params.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, AoParams, params)
BUFFER_RW(2, FilmPixel, film)

KERNEL(ao) {
    FilmWindow w = window[0];
    uvec2 local = film_pixel_of(index, w.pixels);
    uint place = local.y * w.pixels.z + local.x;
    FilmPixel pixel = film[place];
    uint rays = 0u;
    uint i = 0u;
    for (; i < w.samples.y; ++i) {
        CameraSample camera = camera_sample(w, local, i);
        float seen = 0.0f;
        Surface s;
        if (intersect_scene(camera.ray.origin, camera.ray.direction, s, rays)) {
            Frame frame = frame_from_z(face_forward(s.ng, -camera.ray.direction));
            int k = 0;
            for (; k < params[0].rays; ++k) {
                vec3 direction = to_world(frame, sample_cosine_hemisphere(sample_2d(camera.numbers)));
                float limit = min(params[0].distance, INFINITE_DISTANCE);
                seen += scene_openness(s.position, s.error, s.ng, direction, limit, rays);
            }
            if (k != params[0].rays) REPORT_UNFINISHED();
            seen = seen / float(params[0].rays);
            pixel.normal += vec4(s.ns.x, s.ns.y, s.ns.z, 0.0f);
            pixel.squares.w += s.distance;
            pixel.albedo.w += 1.0f;
        }
        film_add(pixel, vec3(seen), camera.weight, camera.pass);
    }
    if (i != w.samples.y) REPORT_UNFINISHED();
    pixel.counts.y += rays;
    film[place] = pixel;
}

// Eye pass: follows camera rays over (nearly) specular surfaces to the first other one, and records the hit point.
#include "core/kernel/scene.h"

#include "integrators/photon_paths/eye_path.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RW(2, FilmPixel, film)
BUFFER_RW(3, HitPointRecord, hits)
BUFFER_RW(4, vec4, queries)
BUFFER_RO(5, PhotonPass, passes)

KERNEL(eye_pass) {
    FilmWindow w = window[0];
    uvec2 local = film_pixel_of(index, w);
    uint place = local.y * w.width + local.x;
    FilmPixel pixel = film[place];
    uint pixels = w.width * w.height;
    uint branches = passes[0].branches;
    uint count = w.samples * branches;
    uint i = 0u;
    for (; i < count; ++i) {
        uint at = ((w.first_sample * branches + i) % passes[0].points) * pixels + place;
        CameraSample camera = camera_sample(w, local, i / branches);
        HitPointRecord hit = no_hit();
        vec4 query;
        PATH_LOG(log_path(LOG_CAMERA_PATH, at, 0u));
        EyePath path = eye_path_begin(camera.ray, camera_medium());
        FirstHit first = no_first_hit();
        uint branch = EYE_BRANCH_CHANCE;
        if (branches == 2u) branch = i % 2u == 0u ? EYE_BRANCH_GATHERS : EYE_BRANCH_FOLLOWS;
        follow_eye_path(camera.numbers, true, branch, path, first, hit, query);
        hit.throughput = slot_of(path.walk.throughput, camera.weight);
        film_add_first_hit(pixel, first);
        hits[at] = hit;
        queries[at] = query;
    }
    if (i != count) REPORT_UNFINISHED();
    pixel.rays += traced_rays[0];
    film[place] = pixel;
}

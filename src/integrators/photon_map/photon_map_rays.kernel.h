// Final gathering: follows a ray from each hit point over (nearly) specular surfaces to the next other one, where the
// map is looked up.
#include "core/kernel/scene.h"

#include "integrators/photon_paths/eye_path.h"
#include "core/kernel/photon.h"
#include "integrators/photon_paths/hit_point.h"

BUFFER_RO(0, FilmWindow, window)  // first_sample: index of the ray, counted over all passes
BUFFER_RW(2, FilmPixel, film)
BUFFER_RO(3, HitPointRecord, hits)
BUFFER_RO(4, vec4, places)
BUFFER_RW(5, HitPointRecord, ends)
BUFFER_RW(6, vec4, queries)

CONST uint GATHER_STREAM = 0x2545f491u;  // makes the random numbers independent of those of eye paths

KERNEL(photon_map_rays) {
    FilmWindow w = window[0];
    HitPointRecord end = no_hit();
    vec4 query = vec4(0.0f, 0.0f, 0.0f, -1.0f);
    if (places[index].w >= 0.0f) {
        HitPointRecord hit = hits[index];
        Surface s;
        Vertex v = hit_vertex(hit, s);
        uint number = film_pixel_number(uvec2(index % w.width, index / w.width), w);
        // Rays of all passes are one stratified set.
        Sampler numbers = sampler_begin(number, w.first_sample, w.seed ^ GATHER_STREAM, w.sampler_kind);
        EyePath path = eye_path_begin(ray_of(s.position, hit_direction(hit)), hit_medium(hit));
        path.walk.depth = int(hit_number(hit)) - 1;
        // Specular lobes at this point belong to the eye path, which follows them from the camera.
        if (eye_path_scatters(s, v, numbers, EYE_LOBES_OTHER, path.walk)) {
            FirstHit unseen = no_first_hit();
            follow_eye_path(numbers, false, EYE_BRANCH_CHANCE, path, unseen, end, query);
            end.throughput = slot_of(path.walk.throughput, 1.0f);
            film[index].rays += traced_rays[0];
        }
    }
    ends[index] = end;
    queries[index] = query;
}

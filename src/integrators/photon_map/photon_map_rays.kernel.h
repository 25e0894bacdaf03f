// Final gathering: a ray from each hit point, over (nearly) specular surfaces to the next one, where the map is looked up.
// clang-format off
#define KERNEL_CPU_VARIANTS kAllEffects, kTexturedEffects, kGlassEffects
// clang-format on
#include "core/kernel/scene.h"

#include "integrators/sppm/eye_path.functions.h"
#include "core/kernel/photon.h"
#include "integrators/sppm/hit_point.functions.h"

BUFFER_RO(0, FilmWindow,
          window)  // samples.x: of the pass's first ray, counted over all passes; w.pixels as in sppm_eye
BUFFER_RW(2, FilmPixel, film)
BUFFER_RO(3, SppmHit, hits)
BUFFER_RO(4, vec4, places)
BUFFER_RW(5, SppmHit, ends)
BUFFER_RW(6, vec4, queries)

CONST uint GATHER_STREAM = 0x2545f491u;  // keeps the numbers apart from those of eye paths

KERNEL(photon_map_rays) {
    FilmWindow w = window[0];
    SppmHit end = no_hit();
    vec4 query = vec4(0.0f, 0.0f, 0.0f, -1.0f);
    if (places[index].w >= 0.0f) {
        SppmHit hit = hits[index];
        vec3 direction = hit_direction(hit);
        Surface s = hit_surface(hit);
        Vertex v = vertex_at(s, direction);
        uint x = w.x + index % w.width;
        uint y = w.y + index / w.width;
        // Rays of all passes are one stratified set.
        Sampler numbers =
            sampler_begin(y * scene[0].camera.resolution_x + x, w.first_sample, w.seed ^ GATHER_STREAM, w.sampler_kind);
        EyePath path = eye_path_begin(ray_of(s.position, direction), hit_medium(hit));
        path.walk.depth = int(hit_number(hit)) - 1;
        // A specular lobe here is the eye path's: what comes over it is followed from the camera.
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

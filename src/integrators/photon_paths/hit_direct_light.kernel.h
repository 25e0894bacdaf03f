// Direct light at the window's range of hit points. They are permanent, so light is sampled again in every pass: the
// eye path, which is followed once, would sample it only once.
#include "core/kernel/scene.h"

#include "core/kernel/film.h"
#include "core/kernel/photon.h"
#include "integrators/photon_paths/hit_point.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, PhotonPass, passes)
BUFFER_RW(2, FilmPixel, film)
BUFFER_RW(3, HitPointRecord, hits)
BUFFER_RO(4, vec4, queries)
BUFFER_RW(5, vec4, ways)  // radiance of each eye path before its hit point

CONST uint DIRECT_STREAM = 0x3c6ef372u;  // makes the random numbers independent of those of eye paths

KERNEL(hit_direct_light) {
    FilmWindow w = window[0];
    uint number = film_pixel_number(uvec2(index % w.width, index / w.width), w);
    uint pixels = w.width * w.height;
    uint pass = passes[0].number;
    uint points = passes[0].points;
    uint i = 0u;
    for (; i < w.samples; ++i) {
        uint point = w.first_sample + i;
        uint at = point * pixels + index;
        if (pass == 0u) ways[at] = hits[at].radiance;
        if (queries[at].w < 0.0f) continue;
        HitPointRecord hit = hits[at];
        Surface s;
        Vertex v = hit_vertex(hit, s);
        // The points of all passes are one stratified set.
        Sampler numbers = sampler_begin(number, pass * points + point, w.seed ^ DIRECT_STREAM, w.sampler_kind);
        // A light without extent is found in the same direction again.
        v.bsdf.walk = hash_combine(numbers.key, numbers.index);
        uint u_light = 0u;
        if (light_choice_needs_number()) u_light = sample_bits_1d_at(numbers, 0u);
        PATH_LOG(log_path(LOG_CAMERA_PATH, at, LOG_ORDER_LATER));
        PATH_LOG(log_at(hit_number(hit) - 1u));
        PATH_LOG(log_carries(spectrum_of(hit.throughput)));
        Spectrum arriving = direct_light(s, v, hit_medium(hit), u_light, sample_bits_2d_at(numbers, 1u), false);
        Spectrum radiance = spectrum_of(ways[at]) + spectrum_of(hit.throughput) * arriving;
        hits[at].radiance = slot_of(radiance, hit.radiance.w);
    }
    if (i != w.samples) REPORT_UNFINISHED();
    film[index].rays += traced_rays[0];
}

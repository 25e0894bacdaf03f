// Ends a pass: one sample for each pixel, of what its camera path found, also by merging, and of the splats.
#include "core/kernel/scene.h"

#include "core/kernel/film.h"
#include "integrators/bidirectional/path_vertex.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, BidirectionalPass, passes)
BUFFER_RW(2, FilmPixel, film)
BUFFER_RO(3, uint, splats)
BUFFER_RO(4, vec4, seen)
BUFFER_RO(5, PathVertexRecord, merged)
BUFFER_RO(6, uint, last_merged)
BUFFER_RO(7, vec4, gathered)

#include "core/kernel/splat_sum.h"

KERNEL(bidirectional_pixels) {
    vec4 own = seen[index];
    Spectrum radiance = spectrum_of(own);
    if (passes[0].eta > 0.0f) {
        uint slot = last_merged[index];
        uint turn = 0u;
        for (; slot != NONE && turn < 65536u; ++turn) {
            radiance += spectrum_of(gathered[slot]);
            slot = path_vertex_previous(merged[slot]);
        }
        if (slot != NONE) REPORT_UNFINISHED();
    }
    PATH_LOG(log_film_sample(0u, radiance, own.w));
    uint lost;
    vec3 splatted = splat_sum(index, passes[0].quantum, lost);
    // A lost splat makes the whole sample one that is left out, and reported.
    vec3 value = lost == 0u ? film_sensor(radiance) * own.w + splatted : vec3(uintBitsToFloat(0x7f800000u));
    FilmPixel pixel = film[index];
    film_add(pixel, value, 1.0f, window[0].first_sample);
    film[index] = pixel;
}

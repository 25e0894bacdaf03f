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
BUFFER_RO(8, float, connected)
BUFFER_RW(9, vec4,
          shares)  // of each pixel, in the mean of channels: what camera paths find alone, connections, splats, merging

#include "core/kernel/splat_sum.h"

KERNEL(bidirectional_pixels) {
    vec4 own = seen[index];
    Spectrum radiance = spectrum_of(own);
    Spectrum by_merging = Spectrum(0.0f);
    if (passes[0].eta > 0.0f) {
        uint slot = last_merged[index];
        uint turn = 0u;
        for (; slot != NONE && turn < 65536u; ++turn) {
            Spectrum found = spectrum_of(gathered[slot]);
            radiance += found;
            by_merging += found;
            slot = path_vertex_previous(merged[slot]);
        }
        if (slot != NONE) REPORT_UNFINISHED();
    }
    PATH_LOG(log_film_sample(0u, radiance, own.w));
    uint lost;
    vec3 splatted = splat_sum(index, passes[0].quantum, lost);
    // A lost splat makes the whole sample one that is left out, and reported.
    if (passes[0].shares != 0u) {
        vec3 to_mean = vec3(1.0f / 3.0f);
        float alone = dot3(film_sensor(spectrum_of(own)), to_mean) - connected[index];
        float by_merged = dot3(film_sensor(by_merging), to_mean);
        shares[index] += vec4(alone * own.w, connected[index] * own.w, dot3(splatted, to_mean), by_merged * own.w);
    }
    vec3 value = lost == 0u ? film_sensor(radiance) * own.w + splatted : vec3(uintBitsToFloat(0x7f800000u));
    FilmPixel pixel = film[index];
    film_add(pixel, value, 1.0f, window[0].first_sample);
    film[index] = pixel;
}

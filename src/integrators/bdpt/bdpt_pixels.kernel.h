// Ends a pass: one sample for each pixel, of what its camera path found and of the splats.
#include "core/kernel/scene.h"

#include "core/kernel/film.h"
#include "integrators/bidirectional/bidirectional_layout.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, BidirectionalPass, passes)
BUFFER_RW(2, FilmPixel, film)
BUFFER_RO(3, uint, splats)
BUFFER_RO(4, vec4, seen)

#include "core/kernel/splat_sum.h"

KERNEL(bdpt_pixels) {
    uint lost;
    vec3 splatted = splat_sum(index, passes[0].quantum, lost);
    // A lost splat makes the whole sample one that is left out, and reported.
    vec3 value = lost == 0u ? vec3(seen[index]) + splatted : vec3(uintBitsToFloat(0x7f800000u));
    FilmPixel pixel = film[index];
    film_add(pixel, value, 1.0f, window[0].first_sample);
    film[index] = pixel;
}

// Ends a pass: one sample for each pixel, of independent paths with at most one scattering vertex, and of the splats of longer
// ones.
#include "integrators/path/path.radiance.h"

#include "core/kernel/scene.h"
#include "core/kernel/film.h"
#include "integrators/mlt/mlt_layout.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RW(2, FilmPixel, film)
BUFFER_RO(3, MltPass, mlt)
BUFFER_RO(4, uint, splats)

#include "core/kernel/splat_sum.h"

KERNEL(mlt_pixels) {
    FilmWindow w = window[0];
    MltPass pass = mlt[0];
    uvec2 local = film_pixel_of(index, w);
    uint at = local.y * w.width + local.x;
    FilmPixel pixel = film[at];
    vec3 direct = vec3(0.0f);
    uint i = 0u;
    for (; i < pass.samples; ++i) {
        CameraSample camera = camera_sample(w, local, i);
        FirstHit first = no_first_hit();
        PATH_LOG(log_path(LOG_CAMERA_PATH, i, 0u));
        Spectrum radiance = radiance_along(camera.ray, camera.numbers, first);
        PATH_LOG(log_film_sample(i, radiance, camera.weight / float(pass.samples)));
        direct += film_sensor(radiance) * camera.weight;
        if (i == 0u) film_add_first_hit(pixel, first);
    }
    if (i != pass.samples) REPORT_UNFINISHED();
    PATH_LOG(log_sample(LOG_CHAIN, 0u, Spectrum(0.0f), vec3(0.0f), pass.brightness));
    uint lost;
    vec3 splatted = splat_sum(at, pass.quantum, lost) * pass.brightness;
    vec3 value = lost == 0u ? direct / float(pass.samples) + splatted : vec3(uintBitsToFloat(0x7f800000u));
    film_add(pixel, value, 1.0f, w.first_sample / pass.samples);
    pixel.rays += traced_rays[0];
    film[at] = pixel;
}

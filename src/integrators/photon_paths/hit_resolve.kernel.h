// Ends a pass for the window's range of hit points: converts gathered flux to radiance, adds it to the film as a
// sample, and shrinks the radii.
#include "core/kernel/scene.h"

#include "core/kernel/film.h"
#include "core/kernel/photon.h"
#include "integrators/photon_paths/hit_record.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, PhotonPathParams, params)
BUFFER_RW(2, FilmPixel, film)
BUFFER_RO(3, PhotonPass, passes)
BUFFER_RO(4, HitPointRecord, hits)
BUFFER_RO(5, vec4, queries)
BUFFER_RO(6, vec4, gathered)
BUFFER_RO(8, vec4, biases)
BUFFER_RW(9, FilmBias, film_bias)
BUFFER_RW(7, vec2, statistics)  // x: squared radius over that of the first pass; y: photons that count so far (N)

// Scales the squared radius after M more photons (Hachisuka et al. 2008, equation 7): R'^2 = R^2 (N + a M) / (N + M).
FN vec2 shrink(vec2 statistic, float found) {
    if (!(found > 0.0f)) return statistic;
    float kept = statistic.y + params[0].alpha * found;
    return vec2(statistic.x * (kept / (statistic.y + found)), kept);
}

KERNEL(hit_resolve) {
    FilmWindow w = window[0];
    uint pixels = w.width * w.height;
    FilmPixel pixel = film[index];
    uint i = 0u;
    uint branches = passes[0].branches;
    uint count = w.samples * branches;
    Spectrum radiance = Spectrum(0.0f);
    Spectrum bias = Spectrum(0.0f);
    for (; i < count; ++i) {
        uint at = ((w.first_sample * branches + i) % passes[0].points) * pixels + index;
        HitPointRecord hit = hits[at];
        radiance += spectrum_of(hit.radiance);
        vec4 q = queries[at];
        if (q.w >= 0.0f) {
            vec4 sum = gathered[at];
            // Adding flux over area in every pass equals the shared-statistics estimate tau / (pi R^2), without its
            // rescaling: tau_n / R_n^2 = sum of Phi_i / R_i^2.
            Spectrum share = spectrum_of(hit.throughput) * (1.0f / (PI * max(q.w * q.w, SMALLEST_RADIUS_SQUARED)));
            radiance += share * spectrum_of(sum);
            bias += share * spectrum_of(biases[at]);
            statistics[at] = shrink(statistics[at], sum.w);
        }
        if ((i + 1u) % branches != 0u) continue;  // the branches of a path are one sample
        if (LOGS_PATHS) {
            for (uint b = 0u; b < branches; ++b) log_film_sample(at - b * pixels, radiance, hit_filter_weight(hit));
        }
        if (film_add(pixel, film_sensor(radiance), hit_filter_weight(hit), passes[0].number))
            film_add_bias(film_bias[index], rgb_of(bias) * scene[0].camera.imaging_ratio, hit_filter_weight(hit));
        radiance = Spectrum(0.0f);
        bias = Spectrum(0.0f);
    }
    if (i != count) REPORT_UNFINISHED();
    film[index] = pixel;
}

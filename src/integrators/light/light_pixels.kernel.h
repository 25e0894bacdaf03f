// Ends a pass of light tracing: one sample for each pixel, of the light that the camera sees directly and of the splats.
//
// Splats are sums over the pass, so the camera's part is multiplied by its filter weight and counts as a sample of weight 1:
// a quotient by the sum of weights would be biased, and is undefined where negative lobes make that sum 0.
#include "core/kernel/scene.h"

#include "core/kernel/film.h"
#include "integrators/light/light_layout.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, LightPass, passes)
BUFFER_RW(2, FilmPixel, film)
BUFFER_RO(3, uint, splats)

#include "core/kernel/splat_sum.h"

// Light that reaches the camera without scattering, which light paths leave out.
FN Spectrum directly_seen(IN(Ray) ray, INOUT(FirstHit) first) {
    Walk walk = walk_begin(ray, camera_medium(), TRANSPORT_RADIANCE, 0);
    Spectrum radiance = Spectrum(0.0f);
    Surface s;
    while (walk_next(walk, s)) {
        Spectrum emitted = walk.throughput * light_emission(s, -walk.ray.direction);
        radiance += emitted;
        PATH_LOG(log_emission(s, emitted, 1.0f));
        if (walk_crosses(walk, s)) continue;
        Vertex v = walk_vertex(walk, s);
        first = first_hit(s, bsdf_albedo(v.bsdf), distance_of(s.position, ray.origin));
        break;
    }
    if (HAS(EFFECT_ENVIRONMENT) && walk.escaped) {
        Spectrum emitted = walk.throughput * environment_radiance(walk.ray.direction);
        radiance += emitted;
        PATH_LOG(log_environment(walk.ray.direction, emitted, 1.0f));
    }
    return radiance;
}

KERNEL(light_pixels) {
    FilmWindow w = window[0];
    uvec2 local = film_pixel_of(index, w);
    uint at = local.y * w.width + local.x;
    CameraSample camera = camera_sample(w, local, 0u);
    FirstHit first = no_first_hit();
    Spectrum radiance = directly_seen(camera.ray, first);
    PATH_LOG(log_film_sample(0u, radiance, camera.weight));
    vec3 seen = film_sensor(radiance) * camera.weight;
    uint lost;
    vec3 splatted = splat_sum(at, passes[0].quantum, lost);
    FilmPixel pixel = film[at];
    film_add_first_hit(pixel, first);
    // A lost splat makes the whole sample one that is left out, and reported.
    vec3 value = lost == 0u ? seen + splatted : vec3(uintBitsToFloat(0x7f800000u));
    film_add(pixel, value, 1.0f, camera.pass);
    pixel.rays += traced_rays[0];
    film[at] = pixel;
}

// Measures how much light reaches the front of a disk: by photons from the lights, and by sampling lights from its points.
#include "core/kernel/scene.h"

struct EmissionProbe {
    uvec4 what;   // x: 0 photons, 1 lights; y: seed
    vec4 centre;  // w: radius
    vec4 normal;
};

BUFFER_RO(0, EmissionProbe, probe)
BUFFER_RW(1, vec4, results)  // one estimate of the flux (W per channel)

FN vec2 two_numbers(INOUT(Rng) rng) {
    float x = rng_float(rng);
    return vec2(x, rng_float(rng));
}

KERNEL(emission_probe) {
    EmissionProbe p = probe[0];
    vec3 n = vec3(p.normal);
    Rng rng = rng_begin(p.what.y, index);
    uint choice = rng_bits(rng);
    float side = rng_float(rng);
    vec2 u = two_numbers(rng);
    uvec2 v = uvec2(0u);
    v.x = rng_bits(rng);
    v.y = rng_bits(rng);
    Spectrum flux = Spectrum(0.0f);
    if (p.what.x == 0u) {
        Emission e;
        if (emit_photon(choice, side, u, v, e)) {
            float along = dot3(e.direction, n);
            float t = dot3(vec3(p.centre) - e.origin, n) / along;
            vec3 at = e.origin + t * e.direction;
            if (along < 0.0f && t > 0.0f && length_of(at - vec3(p.centre)) <= p.centre.w) flux = e.power;
        }
    } else {
        vec2 disk = p.centre.w * sample_concentric_disk(u);
        Frame frame = frame_from_z(n);
        LightSample light;
        if (light_sample(vec3(p.centre) + frame.x * disk.x + frame.y * disk.y, choice, v, false, light)) {
            float area = PI * p.centre.w * p.centre.w;
            flux = light.radiance * (max(dot3(light.wi, n), 0.0f) * area / light.pdf);
        }
    }
    results[index] = slot_of(flux, 0.0f);
}

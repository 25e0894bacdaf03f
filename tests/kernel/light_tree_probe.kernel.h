// The tree of lights: what it chooses, and with which probability.
#include "core/kernel/scene.h"

CONST uint TREE_PROBABILITY = 0u;  // of every light, in order: results[index].x
CONST uint TREE_CHOICE = 1u;       // results[index]: light (bits), its probability
CONST uint TREE_ARRIVES = 2u;      // results[index].x: 1 if a sample of light `what.y` arrives, by random numbers

struct LightTreeProbe {
    uvec4 what;  // TREE_*, light, seed
    vec4 ref_p;
};

BUFFER_RO(0, LightTreeProbe, probe)
BUFFER_RW(1, vec2, results)

KERNEL(light_tree_probe) {
    LightTreeProbe p = probe[0];
    vec3 ref_p = vec3(p.ref_p);
    Rng rng = rng_begin(p.what.z, index);
    vec2 result = vec2(0.0f);
    if (p.what.x == TREE_PROBABILITY) {
        result.x = light_choice_probability(index, ref_p);
    } else if (p.what.x == TREE_CHOICE) {
        LightChoice chosen = choose_light_by_tree(ref_p, rng_bits(rng));
        result = vec2(uintBitsToFloat(chosen.light), chosen.probability);
    } else {
        LightSample s;
        s.is_delta = 0u;
        s.radiance = Spectrum(0.0f);
        uvec2 u;
        u.x = rng_bits(rng);
        u.y = rng_bits(rng);
        bool arrives = lights[p.what.y].kind <= LIGHT_GEOMETRY
                           ? sample_area_light(p.what.y, 1.0f, ref_p, unit_floats(u), s)
                           : sample_point_light(p.what.y, 1.0f, ref_p, s);
        result.x = arrives ? 1.0f : 0.0f;
    }
    results[index] = result;
}

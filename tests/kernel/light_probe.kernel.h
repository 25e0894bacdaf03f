// Queries lights: samples them from a point, and computes the density with which a direction from a point would have been
// sampled.
#include "core/kernel/scene.h"

CONST uint PROBE_SAMPLE =
    0u;  // results[2 i ...]: wi, pdf (0: none found); (radiance.x, distance, light_pdf of what wi meets first, its distance)
CONST uint PROBE_PDF =
    1u;  // inputs[i]: direction; results[2 i ...]: radiance of what it meets first, pdf summed over all
         // that it meets; (distance, number of hits, pdf of the first, -)

struct LightProbe {
    uvec4 what;  // operation, seed, light, whether samples are weighed against those of a BSDF
    vec4 ref_p;
};

BUFFER_RO(0, LightProbe, probe)
BUFFER_RO(1, vec4, inputs)
BUFFER_RW(2, vec4, results)

// What a ray from the reference point meets if the light is alone.
FN bool meet_light(uint light, vec3 o, vec3 d, INOUT(Surface) s) {
    LightRecord record = lights[light];
    s.light = light;
    s.geometry = record.geometry;
    s.primitive = record.primitive;
    if (record.kind == LIGHT_TRIANGLE) {
        vec3 p0 = record.p0;
        vec3 e1 = record.p1 - p0;
        vec3 e2 = record.p2 - p0;
        vec3 p = cross3(d, e2);
        float determinant = dot3(e1, p);
        if (determinant == 0.0f) return false;
        float b1 = dot3(o - p0, p) / determinant;
        vec3 q = cross3(o - p0, e1);
        float b2 = dot3(d, q) / determinant;
        s.distance = dot3(e2, q) / determinant;
        if (!(b1 >= 0.0f && b2 >= 0.0f && b1 + b2 <= 1.0f && s.distance > 0.0f)) return false;
        s.position = p0 + b1 * e1 + b2 * e2;
        s.ng = unit(cross3(e1, e2));
        s.uv = vec2(b1, b2);
        return true;
    }
    if (geometries[record.geometry].kind == GEOMETRY_BILINEAR)
        return bilinear_surface(record.geometry, record.primitive, o, d, s);
    return quadric_surface(record.geometry, o, d, s);
}

KERNEL(light_probe) {
    LightProbe p = probe[0];
    vec3 ref_p = vec3(p.ref_p);
    bool sampling = p.what.x == PROBE_SAMPLE;
    vec3 d = vec3(inputs[sampling ? 0u : index]);
    uint light = p.what.z;
    LightSample found;
    found.pdf = 0.0f;
    bool look = true;
    if (sampling) {
        Rng rng = rng_begin(p.what.y, index);
        uint choice = rng_bits(rng);
        uvec2 u;
        u.x = rng_bits(rng);
        u.y = rng_bits(rng);
        bool any = light_sample(ref_p, choice, u, p.what.w != 0u, found);
        if (!any) found.pdf = 0.0f;
        d = found.wi;
        light = found.light;
        look = any && found.is_delta == 0u;
    }
    Spectrum radiance = Spectrum(0.0f);
    float pdf = 0.0f;
    float first = 0.0f;
    float distance = 0.0f;
    float hits = 0.0f;
    if (look && light < scene[0].infinite_lights) {
        radiance = environment_radiance(d);
        pdf = environment_pdf(d, p.what.w != 0u);
        first = pdf;
        hits = 1.0f;
    } else if (look && HAS(EFFECT_AREA_LIGHTS)) {
        // A sampled point may lie behind another one of the same shape: the density of the direction is the sum over all of
        // them.
        vec3 o = ref_p;
        for (int i = 0; i < (sampling ? 1 : 4); ++i) {
            Surface s = no_surface();
            if (!meet_light(light, o, d, s)) break;
            float pdf_here = light_pdf(s, ref_p, d);
            if (i == 0) {
                radiance = light_emission(s, -d);
                first = pdf_here;
                distance = s.distance;
            }
            hits += 1.0f;
            pdf += pdf_here;
            if (lights[light].kind == LIGHT_TRIANGLE) break;
            o = offset_origin(s.position, s.error, s.ng, d);
        }
    }
    results[2u * index] = sampling ? vec4(d, found.pdf) : slot_of(radiance, pdf);
    results[2u * index + 1u] =
        sampling ? vec4(found.radiance[0], found.distance, first, distance) : vec4(distance, hits, first, 0.0f);
}

// Lights: choosing one, sampling it from a reference point, and emission and density for paths that hit one by BSDF
// sampling.
//
// Densities are per solid angle at the reference point (1/sr) and include the probability of choosing the light.
#ifndef LAMPYRIS_KERNEL_LIGHT
#define LAMPYRIS_KERNEL_LIGHT

#include "core/kernel/light_record.h"
#include "core/kernel/triangle_sampling.h"
#include "core/kernel/quadric_sampling.h"
#include "core/kernel/patch_sampling.h"
#include "core/kernel/environment.h"
#include "core/kernel/light_tree.h"

struct LightSample {
    vec3 wi;            // unit direction towards the light
    Spectrum radiance;  // arriving from there if unoccluded; delta lights: only radiance / pdf is meaningful
    float pdf;          // per solid angle, times the probability of choosing the light; delta lights: only the latter
    float distance;     // INFINITE_DISTANCE: the shadow ray leaves the scene
    vec3 end;           // end of the shadow ray, outside of the light's surface (shadow_end)
    uint is_delta;      // 1: rays cannot hit this light, although pdf may be a density (LIGHT_PASSED)
    uint light;
    vec3 position;  // on an area light, and its unit normal there; else undefined
    vec3 ng;
};

// ---- Area lights -----------------------------------------------------------------------------------------------------

// The normal on the side where a one-sided light emits. In pbrt-v4, a mirroring transform turns quadrics inside out for
// ray intersections, but not for light sampling. Here, scattering follows pbrt's intersections, and emission pbrt's
// light sampling.
FN vec3 area_emission_side(uint light, vec3 ng) {
    if (!HAS(EFFECT_QUADRIC_LIGHTS) || lights[light].kind == LIGHT_TRIANGLE) return ng;
    uint geometry = lights[light].geometry;
    uint flags = geometries[geometry].flags;
    bool mirrored = ((flags & GEOMETRY_FLIP) != 0u) != ((flags & GEOMETRY_REVERSED) != 0u);
    return geometries[geometry].kind >= GEOMETRY_SPHERE && mirrored ? -ng : ng;
}

// Radiance that leaves a point of an area light towards w.
FN Spectrum area_emission(uint light, vec3 position, vec3 ng, vec2 uv, vec3 w) {
    if ((lights[light].flags & LIGHT_TWO_SIDED) == 0u && !(dot3(area_emission_side(light, ng), w) > 0.0f))
        return Spectrum(0.0f);
    Spectrum radiance = lights[light].emission;
    if (HAS(EFFECT_LIGHT_TEXTURES) && lights[light].image != NONE) {
        TextureContext context;
        context.position = position;
        context.normal = ng;
        context.uv = uv;
        radiance = radiance * spectrum_of_rgb(max(texture_color(lights[light].image, context), vec3(0.0f)));
    }
    return radiance;
}

// Radiance of the area light at s in direction w (from s to the viewer, unit length); black if s is not on a light.
FN Spectrum light_emission(IN(Surface) s, vec3 w) {
    if (!HAS(EFFECT_AREA_LIGHTS) || s.light == NONE) return Spectrum(0.0f);
    return area_emission(s.light, s.position, s.ng, s.uv, w);
}

// The density with which light_sample(ref_p, ...) samples a point of an area light, which is seen in direction wi.
FN float area_light_pdf(uint index, vec3 ref_p, vec3 position, vec3 ng, vec3 wi) {
    LightRecord light = lights[index];
    float pdf = 0.0f;
    if (!HAS(EFFECT_QUADRIC_LIGHTS) || light.kind == LIGHT_TRIANGLE) {
        pdf = pdf_triangle_light(light, ref_p, position, ng, wi);
    } else if (HAS(EFFECT_BILINEAR) && geometries[light.geometry].kind == GEOMETRY_BILINEAR) {
        pdf = pdf_bilinear_light(light.geometry, light.primitive, ref_p, position, ng, wi);
    } else if (HAS(EFFECT_QUADRICS)) {
        pdf = pdf_quadric_light(light.geometry, ref_p, position, ng, wi);
    }
    return pdf * light_choice_probability(index, ref_p);
}

// The density with which light_sample(ref_p, ...) would have sampled s, where a ray from ref_p in direction wi hit the
// light.
FN float light_pdf(IN(Surface) s, vec3 ref_p, vec3 wi) {
    if (!HAS(EFFECT_AREA_LIGHTS) || s.light == NONE) return 0.0f;
    return area_light_pdf(s.light, ref_p, s.position, s.ng, wi);
}

// The density per area (1/m^2) with which a photon starts at a point of an area light (emission.h). The point is seen
// from ref_p in direction wi.
FN float area_emission_pdf(uint index, vec3 ref_p, vec3 position, vec3 ng, vec3 wi) {
    LightRecord light = lights[index];
    float pdf = light.inverse_area;
    if (HAS(EFFECT_BILINEAR) && light.kind != LIGHT_TRIANGLE && geometries[light.geometry].kind == GEOMETRY_BILINEAR) {
        pdf = pdf_bilinear_light(light.geometry, light.primitive, ref_p, position, ng, wi) * abs_dot(ng, wi) /
              length_squared(position - ref_p);
    } else if (HAS(EFFECT_QUADRICS) && light.kind != LIGHT_TRIANGLE) {
        pdf = pdf_quadric_area(light.geometry, position);
    }
    return pdf * light.choice_probability;
}

// The number of sides on which an area light emits.
FN float light_sides(IN(LightRecord) light) { return (light.flags & LIGHT_TWO_SIDED) != 0u ? 2.0f : 1.0f; }

// A masked light's opacity: the probability that a ray hits it there. A light that all rays pass emits all of its
// light, as in pbrt.
FN float light_alpha(IN(LightRecord) light, vec3 position, vec3 ng, vec2 uv) {
    if ((light.flags & LIGHT_PASSED) != 0u) return 1.0f;
    TextureContext context;
    context.position = position;
    context.normal = ng;
    context.uv = uv;
    return clamp(surface_alpha(light.geometry, context), 0.0f, 1.0f);
}

// Samples a point on an area light, uniformly by area (patches: only if they are plane); false if the area is zero.
FN bool sample_light_area(IN(LightRecord) light, vec2 u, OUT(AreaSample) s) {
    if (!HAS(EFFECT_QUADRIC_LIGHTS) || light.kind == LIGHT_TRIANGLE) {
        s = sample_triangle_area(light, u);
    } else if (HAS(EFFECT_BILINEAR) && geometries[light.geometry].kind == GEOMETRY_BILINEAR) {
        s = sample_bilinear_area(light.geometry, light.primitive, u);
    } else if (HAS(EFFECT_QUADRICS)) {
        s = sample_quadric_area(light.geometry, u);
    } else {
        return false;
    }
    return s.pdf > 0.0f && is_finite(s.pdf);
}

// `choice`: the probability of choosing the light.
FN bool sample_area_light(uint index, float choice, vec3 ref_p, vec2 u, INOUT(LightSample) s) {
    LightRecord light = lights[index];
    ShapeSample shape;
    bool found = false;
    if (!HAS(EFFECT_QUADRIC_LIGHTS) || light.kind == LIGHT_TRIANGLE) {
        found = sample_triangle_light(light, ref_p, u, shape);
    } else if (HAS(EFFECT_BILINEAR) && geometries[light.geometry].kind == GEOMETRY_BILINEAR) {
        found = sample_bilinear_light(light.geometry, light.primitive, ref_p, u, shape);
    } else if (HAS(EFFECT_QUADRICS)) {
        found = sample_quadric_light(light.geometry, ref_p, u, shape);
    }
    if (!found) return false;
    s.wi = shape.wi;
    s.distance = shape.distance;
    s.position = shape.position;
    s.ng = shape.ng;
    s.end = shadow_end(shape.position, shape.offset, shape.ng, shape.wi, shape.distance);
    s.pdf = shape.pdf * choice;
    s.radiance = area_emission(index, shape.position, shape.ng, shape.uv, -shape.wi);
    if (HAS(EFFECT_ALPHA)) {
        s.radiance = s.radiance * light_alpha(light, shape.position, shape.ng, shape.uv);
        s.is_delta = (light.flags & LIGHT_PASSED) != 0u ? 1u : 0u;
    }
    return !is_black(s.radiance);
}

// ---- Lights at a point -----------------------------------------------------------------------------------------------

// The share of a spot light's intensity at an angle to its axis, by 1 - cos: a smooth step in the cosine.
FN float spot_falloff(IN(LightRecord) light, float one_minus_cos) {
    float begin = spot_begin(light);
    float end = spot_end(light);
    if (begin == end) return one_minus_cos > end ? 0.0f : 1.0f;
    float t = clamp((end - one_minus_cos) / (end - begin), 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

// Intensity (W/sr per channel) of a light at a point in direction w (world, unit length), as that of pbrt's lights of
// the same names (4th edition, sections 12.2.1 and 12.2.3).
FN Spectrum point_light_intensity(IN(LightRecord) light, vec3 w) {
    Spectrum intensity = light.emission;
    if (light.kind == LIGHT_SPOT) return intensity * spot_falloff(light, 0.5f * length_squared(w - spot_axis(light)));
    if (HAS(EFFECT_PROJECTION_LIGHTS) && light.kind >= LIGHT_PROJECTION) {
        TransformRecord m = transforms[light.transform];
        vec3 d = unit(transform_vector(m.from0, m.from1, m.from2, w));
        vec2 st;
        if (light.kind == LIGHT_PROJECTION) {
            if (!(d.z >= 1e-3f)) return Spectrum(0.0f);
            vec4 window = projection_window(light);
            st = vec2((d.x / d.z - window.x) / (window.z - window.x), (window.w - d.y / d.z) / (window.w - window.y));
            if (!(st.x >= 0.0f && st.x <= 1.0f && st.y >= 0.0f && st.y <= 1.0f)) return Spectrum(0.0f);
        } else {
            st = square_from_direction(vec3(d.x, d.z, d.y));  // the image's pole is the light's y axis
        }
        intensity = intensity * spectrum_of(image_lookup(light.image, st));
    }
    return intensity;
}

FN bool sample_point_light(uint index, float choice, vec3 ref_p, INOUT(LightSample) s) {
    LightRecord light = lights[index];
    vec3 position = light_position(light);
    vec3 to_light = position - ref_p;
    float d2 = length_squared(to_light);
    if (!(d2 > 0.0f) || !is_finite(d2)) return false;
    s.distance = sqrt(d2);
    s.wi = to_light / s.distance;
    s.end = shadow_end(position, point_offset(position, s.wi), s.wi, s.wi, s.distance);
    s.radiance = point_light_intensity(light, -s.wi) / d2;
    s.pdf = choice;
    s.is_delta = 1u;
    return !is_black(s.radiance);
}

// ---- All lights ------------------------------------------------------------------------------------------------------

// Up to this many lights, u.x picks the light and is rescaled to place the point on it. This needs no other number, and
// stratifies both together. Enough digits are left, because a part of the samples is spread evenly over all lights.
CONST uint LIGHTS_CHOSEN_BY_PLACE = 256u;
FN bool light_choice_needs_number() { return scene[0].light_count > LIGHTS_CHOSEN_BY_PLACE || uses_light_tree(); }

// Chooses a light in proportion to its power, or by the tree of lights, and samples it from ref_p. u_choice and u_place are
// bits of random numbers (random.h). `weighted`: the sample is weighed against one of the BSDF by environment_pdf. False if
// no light arrives.
FN bool light_sample(vec3 ref_p, uint u_choice, uvec2 u_place, bool weighted, OUT(LightSample) s) {
    s.wi = vec3(0.0f, 0.0f, 1.0f);
    s.radiance = Spectrum(0.0f);
    s.pdf = 0.0f;
    s.distance = INFINITE_DISTANCE;
    s.end = vec3(0.0f);
    s.is_delta = 0u;
    s.position = vec3(0.0f);
    s.ng = vec3(0.0f, 0.0f, 1.0f);
    uint count = scene[0].light_count;
    s.light = NONE;
    if (count == 0u) return false;
    uvec2 u = u_place;
    float choice = 0.0f;
    if (HAS(EFFECT_LIGHT_TREE) && uses_light_tree()) {
        LightChoice chosen = choose_light_by_tree(ref_p, u_choice);
        s.light = chosen.light;
        choice = chosen.probability;
    } else if (light_choice_needs_number()) {
        s.light = find_interval(scene[0].light_cdf, count, cdf_number(u_choice));
    } else if (count == 1u) {
        s.light = 0u;
    } else {
        uint number = cdf_number(u.x);
        s.light = find_interval(scene[0].light_cdf, count, number);
        float place = place_in_interval(scene[0].light_cdf + s.light, number, 0.5f);
        // Back to bits: those below a float's precision are hashed from the other number.
        u.x = (uint(place * 16777216.0f) << 8u) | (hash32(u.y) >> 24u);
    }
    if (!HAS(EFFECT_LIGHT_TREE) || !uses_light_tree()) choice = choice_by_power(s.light);
    uint kind = lights[s.light].kind;
    if (HAS(EFFECT_AREA_LIGHTS) && kind <= LIGHT_GEOMETRY)
        return sample_area_light(s.light, choice, ref_p, unit_floats(u), s);
    if (HAS(EFFECT_ENVIRONMENT) && (kind == LIGHT_INFINITE || kind == LIGHT_INFINITE_IMAGE)) {
        return environment_sample(s.light, u, weighted, s.wi, s.radiance, s.pdf) && !is_black(s.radiance);
    }
    if (HAS(EFFECT_DISTANT_LIGHTS) && kind == LIGHT_DISTANT) {
        s.wi = light_direction(lights[s.light]);
        s.radiance = lights[s.light].emission;
        s.pdf = choice;
        s.is_delta = 1u;
        return true;
    }
    if (HAS(EFFECT_POINT_LIGHTS) || HAS(EFFECT_PROJECTION_LIGHTS)) return sample_point_light(s.light, choice, ref_p, s);
    return false;
}

#endif

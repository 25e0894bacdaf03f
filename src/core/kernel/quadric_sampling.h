// Sampling of points on spheres, disks and cylinders that emit (shape_sample.h).
#ifndef LAMPYRIS_KERNEL_QUADRIC_SAMPLING
#define LAMPYRIS_KERNEL_QUADRIC_SAMPLING

#include "core/kernel/shape_sample.h"

FN float determinant_of(vec4 r0, vec4 r1, vec4 r2) { return dot3(vec3(r0), cross3(vec3(r1), vec3(r2))); }

// Area in the quadric's own space.
FN float quadric_area(uint kind, IN(Quadric) q) {
    if (kind == GEOMETRY_DISK) return 0.5f * q.phi_max * (q.radius - q.inner_radius) * (q.radius + q.inner_radius);
    return q.phi_max * q.radius * (q.z_max - q.z_min);
}

FN bool sphere_is_whole(IN(Quadric) q) { return q.z_min <= -q.radius && q.z_max >= q.radius && q.phi_max >= TWO_PI; }

// Density per area (set's space) of sampling the quadric uniformly in its own space, at a point where its normal in the
// set's space (quadric_set_normal) has the given length.
FN float quadric_pdf_area(IN(GeometryRecord) g, IN(TransformRecord) m, float normal_length) {
    return abs(determinant_of(m.from0, m.from1, m.from2)) / (quadric_area(g.kind, g.quadric) * normal_length);
}

// Uniform by area, in the quadric's own space.
FN vec3 sample_quadric_point(uint kind, IN(Quadric) q, vec2 u) {
    if (kind == GEOMETRY_DISK) {
        if (q.inner_radius == 0.0f && q.phi_max >= TWO_PI) {
            vec2 d = sample_concentric_disk(u);
            return vec3(q.radius * d.x, q.radius * d.y, q.height);
        }
        float r = sqrt(lerp_of(u.x, q.inner_radius * q.inner_radius, q.radius * q.radius));
        return spherical_direction(r, q.height, u.y * q.phi_max);
    }
    float z = lerp_of(u.x, q.z_min, q.z_max);
    float r = kind == GEOMETRY_SPHERE ? safe_sqrt((q.radius - z) * (q.radius + z)) : q.radius;
    return spherical_direction(r, z, u.y * q.phi_max);
}

// 1 - cos of the half angle of the cone that a whole sphere subtends from `ref_p` (quadric's space); 0 from inside, and where
// rounding hides on which side ref_p is. `m` is the quadric's transform.
FN float sphere_cone(IN(Quadric) q, IN(TransformRecord) m, vec3 ref_p) {
    vec3 f = ref_p / q.radius;
    float d2 = length_squared(f);
    float moved = max(max(abs(m.from0.w), abs(m.from1.w)), abs(m.from2.w));
    if (!(d2 - 1.0f > 4e-7f + 4e-7f * moved / q.radius)) return 0.0f;
    float sin2 = 1.0f / d2;
    return sin2 / (1.0f + sqrt(1.0f - sin2));
}

// Whether points outside of a whole sphere receive its light only from the side that faces them. This is false if rays
// may pass that side (alpha) and the far side emits inwards.
FN bool sphere_hides_its_inside(IN(GeometryRecord) g) {
    if (!HAS(EFFECT_ALPHA) || (g.alpha_texture == NONE && g.alpha >= 1.0f)) return true;
    return (g.flags & GEOMETRY_REVERSED) == 0u && (lights[g.first_light].flags & LIGHT_TWO_SIDED) == 0u;
}

// Solid angle in the quadric's space per solid angle in the set's space, around a direction whose length the transform
// multiplies by `stretch`. The order of the products keeps them within a float's range.
FN float sphere_cone_stretch(IN(TransformRecord) m, float stretch) {
    return abs(determinant_of(m.from0, m.from1, m.from2)) * stretch * stretch * stretch;
}

FN AreaSample sample_quadric_area(uint geometry, vec2 u) {
    GeometryRecord g = geometries[geometry];
    vec3 p = sample_quadric_point(g.kind, g.quadric, u);
    AreaSample s;
    s.position = quadric_set_position(geometry, p, s.error);
    vec3 n = quadric_set_normal(geometry, p);
    float n_length = length_of(n);
    s.ng = n / n_length;
    s.uv = vec2(0.0f);
    if (HAS(EFFECT_LIGHT_TEXTURES) || HAS(EFFECT_ALPHA)) s.uv = quadric_uv(g.kind, g.quadric, p);
    s.pdf = quadric_pdf_area(g, transforms[g.transform], n_length);
    return s;
}

FN bool sample_quadric_light(uint geometry, vec3 ref_p, vec2 u, OUT(ShapeSample) s) {
    GeometryRecord g = geometries[geometry];
    TransformRecord m = transforms[g.transform];
    uint kind = g.kind;
    s.uv = vec2(0.0f);
    if (kind == GEOMETRY_SPHERE && sphere_is_whole(g.quadric) && sphere_hides_its_inside(g)) {
        vec3 o = transform_point(m.from0, m.from1, m.from2, ref_p);
        float one_minus_cos_max = sphere_cone(g.quadric, m, o);
        if (one_minus_cos_max > 0.0f) {
            // Uniform in the cone that the sphere subtends; distances in units of the radius.
            vec3 f = o / g.quadric.radius;
            float d = length_of(f);
            Frame frame = frame_from_z(f / -d);
            vec3 local = sample_uniform_cone(u, one_minus_cos_max);
            float sin2 = local.x * local.x + local.y * local.y;
            float half_chord = safe_sqrt(1.0f - d * d * sin2);
            // The distance and the point relative to the sphere's centre: no differences of large numbers, however far away or
            // close the sphere is.
            float t = (length_squared(f) - 1.0f) / (d * local.z + half_chord);
            vec3 local_point = vec3(t * local.x, t * local.y, -(d * sin2 + half_chord * local.z));
            vec3 p = to_world(frame, local_point);
            p = p * (g.quadric.radius / length_of(p));
            vec3 w = to_world(frame, local);
            vec3 set_w = transform_vector(m.to0, m.to1, m.to2, w);
            float stretch = length_of(set_w);
            vec3 n = quadric_set_normal(geometry, p);
            s.ng = n / length_of(n);
            s.wi = set_w / stretch;
            s.distance = t * g.quadric.radius * stretch;
            vec3 error;
            s.position = quadric_set_position(geometry, p, error);
            s.offset = way_out_length(s.position, error, s.ng);
            s.pdf = pdf_uniform_cone(one_minus_cos_max) * sphere_cone_stretch(m, stretch);
            if (HAS(EFFECT_LIGHT_TEXTURES) || HAS(EFFECT_ALPHA)) s.uv = quadric_uv(kind, g.quadric, p);
            return is_finite(s.pdf);
        }
    }
    AreaSample place = sample_quadric_area(geometry, u);
    s.position = place.position;
    s.offset = way_out_length(place.position, place.error, place.ng);
    s.ng = place.ng;
    s.uv = place.uv;
    return shape_sample_from_area(ref_p, place.pdf, s);
}

// Density per area at a point of the quadric.
FN float pdf_quadric_area(uint geometry, vec3 position) {
    GeometryRecord g = geometries[geometry];
    TransformRecord m = transforms[g.transform];
    vec3 p = transform_point(m.from0, m.from1, m.from2, position);
    return quadric_pdf_area(g, m, length_of(quadric_set_normal(geometry, p)));
}

FN float pdf_quadric_light(uint geometry, vec3 ref_p, vec3 position, vec3 ng, vec3 wi) {
    GeometryRecord g = geometries[geometry];
    TransformRecord m = transforms[g.transform];
    uint kind = g.kind;
    if (kind == GEOMETRY_SPHERE && sphere_is_whole(g.quadric) && sphere_hides_its_inside(g)) {
        float one_minus_cos_max = sphere_cone(g.quadric, m, transform_point(m.from0, m.from1, m.from2, ref_p));
        if (one_minus_cos_max > 0.0f) {
            float stretch = 1.0f / length_of(transform_vector(m.from0, m.from1, m.from2, wi));
            return pdf_uniform_cone(one_minus_cos_max) * sphere_cone_stretch(m, stretch);
        }
    }
    return pdf_of_area(pdf_quadric_area(geometry, position), length_squared(position - ref_p), dot3(ng, wi));
}

#endif

// Sampling of points on triangles that emit (shape_sample.h).
#ifndef LAMPYRIS_KERNEL_TRIANGLE_SAMPLING
#define LAMPYRIS_KERNEL_TRIANGLE_SAMPLING

#include "core/kernel/shape_sample.h"

// Below this solid angle (sr) a triangle is sampled by area, because distance and cosine vary little over it. At 0.2 sr
// (the lamp of bench/support/terrain.py) sampling by solid angle lowers the image's relMSE by 8.5 % and costs 9.6 %
// more time.
CONST float SPHERICAL_TRIANGLE_MIN = 0.25f;
CONST float SPHERICAL_TRIANGLE_MAX = 6.22f;  // at 2 pi the reference point is in the triangle's plane

// Solid angle of the triangle of unit vectors a, b, c (van Oosterom and Strackee 1983, equation 8).
FN float spherical_triangle_area(vec3 a, vec3 b, vec3 c) {
    return 2.0f * atan2_of(abs(dot3(a, cross3(b, c))), 1.0f + dot3(a, b) + dot3(b, c) + dot3(a, c));
}

// The triangle's solid angle as seen from ref_p, and the unit directions to its corners; 0 if it is to be sampled by
// area.
FN float triangle_sampled_solid_angle(IN(LightRecord) light, vec3 ref_p, OUT(vec3) a, OUT(vec3) b, OUT(vec3) c) {
    // From far away, it is about the foreshortened area over the squared distance: area height / d^3.
    vec3 centre = (light.p0 + light.p1 + light.p2) * (1.0f / 3.0f) - ref_p;
    float d2 = length_squared(centre);
    if (d2 > 4.0f * light.extent * light.extent) {
        float height = dot3(centre, light.normal);
        float ratio = d2 * light.inverse_area;  // so that no product leaves a float's range
        if (height * height < SPHERICAL_TRIANGLE_MIN * SPHERICAL_TRIANGLE_MIN * d2 * (ratio * ratio)) return 0.0f;
    }
    a = light.p0 - ref_p;
    b = light.p1 - ref_p;
    c = light.p2 - ref_p;
    float a2 = length_squared(a);
    float b2 = length_squared(b);
    float c2 = length_squared(c);
    if (!(min(a2, min(b2, c2)) > 0.0f)) return 0.0f;
    a = a / sqrt(a2);
    b = b / sqrt(b2);
    c = c / sqrt(c2);
    float solid_angle = spherical_triangle_area(a, b, c);
    return solid_angle >= SPHERICAL_TRIANGLE_MIN && solid_angle <= SPHERICAL_TRIANGLE_MAX ? solid_angle : 0.0f;
}

// Samples a direction uniformly in the spherical triangle (Arvo 1995, "Stratified Sampling of Spherical Triangles"):
// u.x chooses the fraction of the area that an arc from b to a point c' on the arc ac cuts off, u.y a point on the arc
// b c'.
//
// c' is computed with half angles: with c' at angle theta from a, t the unit tangent there and V = |a . (b x t)|, van
// Oosterom's formula for the triangle a, b, c' of area A reads tan(A/2) = h V / ((1 + a.b) + h b.t), h = tan(theta/2),
// which is linear in h. Unlike Arvo's expressions it does not cancel for small triangles.
FN vec3 sample_spherical_triangle(vec3 a, vec3 b, vec3 c, float solid_angle, vec2 u) {
    float s;
    float k;
    sin_cos(0.5f * u.x * solid_angle, s, k);
    vec3 tangent = (c - a) - a * dot3(a, c - a);
    tangent = tangent / length_of(tangent);
    float volume = abs(dot3(a, cross3(b, tangent)));
    float h_up = s * (1.0f + dot3(a, b));
    float h_down = volume * k - s * dot3(b, tangent);
    float inverse = 1.0f / (h_up * h_up + h_down * h_down);
    // cos and sin of theta, theta = 2 atan(h).
    vec3 c_new = a * ((h_down * h_down - h_up * h_up) * inverse) + tangent * (2.0f * h_up * h_down * inverse);
    vec3 chord = c_new - b;
    float one_minus_cos = 0.5f * u.y * length_squared(chord);
    vec3 side = chord - b * dot3(b, chord);
    float side_length = length_of(side);
    if (!(side_length > 0.0f)) return b;
    return unit(b * (1.0f - one_minus_cos) + side * (safe_sqrt(one_minus_cos * (2.0f - one_minus_cos)) / side_length));
}

// The vertex indices of a triangle's corners.
FN uvec3 triangle_corners(uint geometry, uint primitive) {
    uint first = geometries[geometry].first_index + 3u * primitive;
    return uvec3(indices[first], indices[first + 1u], indices[first + 2u]);
}

RARE_FN vec3 interpolated_light_normal(uint geometry, uint primitive, vec3 barycentric) {
    uint normals_of = geometries[geometry].first_normal;
    uvec3 corner = triangle_corners(geometry, primitive);
    return barycentric.x * vertex_normal(normals_of + corner.x) + barycentric.y * vertex_normal(normals_of + corner.y) +
           barycentric.z * vertex_normal(normals_of + corner.z);
}

// Unit normal of a triangle light, on the side that the geometry's flags or vertex normals determine.
FN vec3 triangle_light_normal(IN(LightRecord) light, vec3 barycentric) {
    vec3 ng = light.normal;
    if (HAS(EFFECT_SMOOTH_NORMALS) && RARELY(light.smooth_normals != 0.0f))
        return face_forward(ng, interpolated_light_normal(light.geometry, light.primitive, barycentric));
    return ng;
}

// Triangles without uvs have pbrt's: (0,0), (1,0), (1,1).
FN vec2 triangle_light_uv(IN(LightRecord) light, vec3 barycentric) {
    if ((HAS(EFFECT_LIGHT_TEXTURES) || HAS(EFFECT_ALPHA)) &&
        (geometries[light.geometry].flags & GEOMETRY_HAS_UVS) != 0u) {
        uint uvs_of = geometries[light.geometry].first_uv;
        uvec3 corner = triangle_corners(light.geometry, light.primitive);
        return barycentric.x * vertex_uv(uvs_of + corner.x) + barycentric.y * vertex_uv(uvs_of + corner.y) +
               barycentric.z * vertex_uv(uvs_of + corner.z);
    }
    return vec2(barycentric.y + barycentric.z, barycentric.z);
}

FN AreaSample sample_triangle_area(IN(LightRecord) light, vec2 u) {
    vec3 barycentric = sample_uniform_triangle(u);
    vec3 p0 = light.p0;
    vec3 p1 = light.p1;
    vec3 p2 = light.p2;
    float off_plane = triangle_plane_error(p1 - p0, p2 - p0, barycentric.y, barycentric.z, 0.5f * light.inverse_area);
    AreaSample s;
    s.position = barycentric.x * p0 + barycentric.y * p1 + barycentric.z * p2;
    s.error = gamma_bound(7.0f) * (abs(barycentric.x * p0) + abs(barycentric.y * p1) + abs(barycentric.z * p2)) +
              off_plane * abs(light.normal);
    s.ng = triangle_light_normal(light, barycentric);
    s.uv = triangle_light_uv(light, barycentric);
    s.pdf = light.inverse_area;
    return s;
}

FN bool sample_triangle_light(IN(LightRecord) light, vec3 ref_p, vec2 u, OUT(ShapeSample) s) {
    vec3 p0 = light.p0;
    vec3 e1 = light.p1 - p0;
    vec3 e2 = light.p2 - p0;
    s.uv = vec2(0.0f);
    s.offset = light.shadow_end;  // from triangle_light (core/scene/area_lights.cpp)
    vec3 a;
    vec3 b;
    vec3 c;
    float solid_angle = triangle_sampled_solid_angle(light, ref_p, a, b, c);
    vec3 barycentric;
    if (solid_angle > 0.0f) {
        s.wi = sample_spherical_triangle(a, b, c, solid_angle, u);
        // Intersects the direction with the triangle's plane (Moeller and Trumbore 1997), clamped to the triangle.
        vec3 pv = cross3(s.wi, e2);
        float determinant = dot3(e1, pv);
        if (determinant == 0.0f) return false;
        vec3 tv = ref_p - p0;
        vec3 qv = cross3(tv, e1);
        float b1 = clamp(dot3(tv, pv) / determinant, 0.0f, 1.0f);
        float b2 = clamp(dot3(s.wi, qv) / determinant, 0.0f, 1.0f - b1);
        barycentric = vec3(1.0f - b1 - b2, b1, b2);
        s.position = p0 + b1 * e1 + b2 * e2;
        s.distance = distance_of(s.position, ref_p);
        s.pdf = 1.0f / solid_angle;
        s.ng = triangle_light_normal(light, barycentric);
    } else {
        barycentric = sample_uniform_triangle(u);
        s.position = p0 + barycentric.y * e1 + barycentric.z * e2;
        s.ng = triangle_light_normal(light, barycentric);
        if (!shape_sample_from_area(ref_p, light.inverse_area, s)) return false;
    }
    s.uv = triangle_light_uv(light, barycentric);
    return true;
}

FN float pdf_triangle_light(IN(LightRecord) light, vec3 ref_p, vec3 position, vec3 ng, vec3 wi) {
    vec3 a;
    vec3 b;
    vec3 c;
    float solid_angle = triangle_sampled_solid_angle(light, ref_p, a, b, c);
    if (solid_angle > 0.0f) return 1.0f / solid_angle;
    return pdf_of_area(light.inverse_area, length_squared(position - ref_p), dot3(ng, wi));
}

#endif

// Bilinear patches: p(u, v) = (1-u)(1-v) p00 + u(1-v) p10 + (1-u)v p01 + uv p11 (pbrt, 4th edition, section 6.6).
#ifndef LAMPYRIS_KERNEL_BILINEAR
#define LAMPYRIS_KERNEL_BILINEAR

struct Patch {
    vec3 p00;
    vec3 p10;
    vec3 p01;
    vec3 p11;
};

// The index of each corner (p00, p10, p01, p11), relative to the geometry's first vertex.
FN uvec4 patch_corners(IN(GeometryRecord) g, uint primitive) {
    uint first = g.first_index + 4u * primitive;
    return uvec4(indices[first], indices[first + 1u], indices[first + 2u], indices[first + 3u]);
}

FN Patch load_patch(uint geometry, uint primitive) {
    GeometryRecord g = geometries[geometry];
    uvec4 corner = patch_corners(g, primitive);
    Patch patch_;
    patch_.p00 = vertex_position(g.first_vertex + corner.x);
    patch_.p10 = vertex_position(g.first_vertex + corner.y);
    patch_.p01 = vertex_position(g.first_vertex + corner.z);
    patch_.p11 = vertex_position(g.first_vertex + corner.w);
    return patch_;
}

FN vec3 patch_position(IN(Patch) b, vec2 uv) {
    return lerp3_of(uv.x, lerp3_of(uv.y, b.p00, b.p01), lerp3_of(uv.y, b.p10, b.p11));
}
FN vec3 patch_dpdu(IN(Patch) b, float v) { return lerp3_of(v, b.p10 - b.p00, b.p11 - b.p01); }
FN vec3 patch_dpdv(IN(Patch) b, float u) { return lerp3_of(u, b.p01 - b.p00, b.p11 - b.p10); }
FN vec3 patch_error(IN(Patch) b) {
    return gamma_bound(8.0f) * max(max(abs(b.p00), abs(b.p10)), max(abs(b.p01), abs(b.p11)));
}

// A computed u or v this far outside of [0, 1] still counts as the edge, so that neighbouring patches leave no crack.
CONST float PATCH_EDGE = 2e-6f;

// Intersects the ray with the patch's line of constant u; keeps the nearer hit.
FN void patch_candidate(vec3 a00, vec3 a10, vec3 a01, vec3 a11, vec3 d, float u, float t_error, INOUT(float) t,
                        INOUT(vec2) uv) {
    if (!(u >= -PATCH_EDGE && u <= 1.0f + PATCH_EDGE)) return;
    float clamped_u = clamp(u, 0.0f, 1.0f);
    vec3 from = lerp3_of(clamped_u, a00, a10);
    vec3 along = lerp3_of(clamped_u, a01, a11) - from;
    // The common perpendicular of ray and line (Reshetov 2019, equation 10).
    vec3 n = cross3(d, along);
    float n2 = length_squared(n);
    if (!(n2 > 0.0f)) return;
    vec3 m = cross3(n, from);
    float v = dot3(m, d) / n2;
    float t_here = dot3(m, along) / n2;
    if (!(v >= -PATCH_EDGE && v <= 1.0f + PATCH_EDGE)) return;
    if (!(t_here > t_error && t_here < t)) return;
    // The tangent plane at the hit must be ahead of the ray, too. For a ray that leaves a plane patch at a grazing
    // angle, the coefficients of the equation for u are only rounding errors, and the line found is one that the ray
    // passes above.
    float clamped_v = clamp(v, 0.0f, 1.0f);
    vec3 normal = cross3(lerp3_of(clamped_v, a10 - a00, a11 - a01), along);
    if ((dot3(from + clamped_v * along, normal) > 0.0f) != (dot3(d, normal) > 0.0f)) return;
    t = t_here;
    uv = vec2(clamped_u, clamped_v);
}

// The first hit with 0 < t < t_max, and its parameters. The ray hits the patch where it hits a line of constant u,
// which gives a quadratic equation in u (A. Reshetov, "Cool Patches: A Geometric Approach to Ray/Bilinear Patch
// Intersections", Ray Tracing Gems, 2019). Positions are relative to the ray's origin, so that patches far from the
// world's origin lose no precision.
//
// Hits at or below t_min do not count, nor do those within the rounding error of the ray's origin.
FN bool bilinear_hit_beyond(uint geometry, uint primitive, vec3 o, vec3 d, float t_min, float t_max, OUT(float) t,
                            OUT(vec2) uv) {
    Patch b = load_patch(geometry, primitive);
    t = t_max;
    uv = vec2(0.0f);
    vec3 a00 = b.p00 - o;
    vec3 a10 = b.p10 - o;
    vec3 a01 = b.p01 - o;
    vec3 a11 = b.p11 - o;
    float quadratic = dot3(cross3(b.p10 - b.p00, b.p01 - b.p11), d);
    float constant = dot3(cross3(a00, d), b.p01 - b.p00);
    float linear = dot3(cross3(a10, d), b.p11 - b.p10) - (quadratic + constant);
    // Scaled so that the discriminant neither overflows nor underflows.
    float largest = max(abs(quadratic), max(abs(constant), abs(linear)));
    if (!(largest > 0.0f) || !is_finite(largest)) return false;
    quadratic = quadratic / largest;
    constant = constant / largest;
    linear = linear / largest;
    float discriminant = linear * linear - 4.0f * quadratic * constant;
    if (!(discriminant >= 0.0f)) return false;
    float root = sqrt(discriminant);
    float q = -0.5f * (linear < 0.0f ? linear - root : linear + root);
    // A hit at or below t_error is the point at which the ray starts.
    float extent = max(max(max_component(abs(b.p00)), max_component(abs(b.p10))),
                       max(max_component(abs(b.p01)), max_component(abs(b.p11))));
    float t_error = max(t_min, gamma_bound(10.0f) * (max_component(abs(o)) + extent) / length_of(d));
    if (q == 0.0f) {  // both roots are 0
        patch_candidate(a00, a10, a01, a11, d, 0.0f, t_error, t, uv);
    } else {
        patch_candidate(a00, a10, a01, a11, d, constant / q, t_error, t, uv);
        if (quadratic != 0.0f) patch_candidate(a00, a10, a01, a11, d, q / quadratic, t_error, t, uv);
    }
    return t < t_max;
}

FN bool bilinear_hit(uint geometry, uint primitive, vec3 o, vec3 d, float t_max, OUT(float) t, OUT(vec2) uv) {
    return bilinear_hit_beyond(geometry, primitive, o, d, 0.0f, t_max, t, uv);
}

// Fills in the surface at the patch's own uv, except for distance, ids, material and light.
FN void bilinear_fill(uint geometry, uint primitive, vec2 uv, INOUT(Surface) s) {
    GeometryRecord g = geometries[geometry];
    Patch b = load_patch(geometry, primitive);
    uvec4 corner = patch_corners(g, primitive);
    s.position = patch_position(b, uv);
    s.error = patch_error(b);
    vec3 dpdu = patch_dpdu(b, uv.y);
    vec3 dpdv = patch_dpdv(b, uv.x);
    vec3 normal = cross3(dpdu, dpdv);
    if (!(max_component(abs(normal)) > 0.0f)) normal = cross3(b.p11 - b.p00, b.p01 - b.p10);  // two corners coincide
    float normal_length = length_of_area(normal);
    s.ng = normal_length > 0.0f ? normal / normal_length : vec3(0.0f, 0.0f, 1.0f);
    // Derivatives of the normal, a unit cross product; the patch's mixed derivative is its twist.
    s.dndu = vec3(0.0f);
    s.dndv = vec3(0.0f);
    bool flip = (g.flags & GEOMETRY_FLIP) != 0u;
    float sign = flip ? -1.0f : 1.0f;
    if (HAS(EFFECT_BUMP) && normal_length > 0.0f) {
        vec3 twist = (b.p00 - b.p10) + (b.p11 - b.p01);
        s.dndu = sign * unit_derivative(s.ng, normal_length, cross3(dpdu, twist));
        s.dndv = sign * unit_derivative(s.ng, normal_length, cross3(twist, dpdv));
    }
    s.ng = sign * s.ng;
    s.ns = s.ng;
    s.uv = uv;
    // du/ds, dv/ds, ...: they convert the patch's own derivatives to those with respect to the vertex uvs (s, t).
    float du_ds = 1.0f;
    float dv_ds = 0.0f;
    float du_dt = 0.0f;
    float dv_dt = 1.0f;
    if ((g.flags & GEOMETRY_HAS_UVS) != 0u) {
        vec2 st00 = vertex_uv(g.first_uv + corner.x);
        vec2 st10 = vertex_uv(g.first_uv + corner.y);
        vec2 st01 = vertex_uv(g.first_uv + corner.z);
        vec2 st11 = vertex_uv(g.first_uv + corner.w);
        vec2 at_u0 = (1.0f - uv.y) * st00 + uv.y * st01;
        vec2 at_u1 = (1.0f - uv.y) * st10 + uv.y * st11;
        s.uv = (1.0f - uv.x) * at_u0 + uv.x * at_u1;
        vec2 dst_du = at_u1 - at_u0;
        vec2 dst_dv = (1.0f - uv.x) * (st01 - st00) + uv.x * (st11 - st10);
        float determinant = dst_du.x * dst_dv.y - dst_du.y * dst_dv.x;
        if (abs(determinant) > 1e-12f) {
            du_ds = dst_dv.y / determinant;
            du_dt = -dst_dv.x / determinant;
            dv_ds = -dst_du.y / determinant;
            dv_dt = dst_du.x / determinant;
        }
    }
    if (HAS(EFFECT_SMOOTH_NORMALS) && (g.flags & GEOMETRY_HAS_NORMALS) != 0u) {
        vec3 n00 = vertex_normal(g.first_normal + corner.x);
        vec3 n10 = vertex_normal(g.first_normal + corner.y);
        vec3 n01 = vertex_normal(g.first_normal + corner.z);
        vec3 n11 = vertex_normal(g.first_normal + corner.w);
        vec3 ns = lerp3_of(uv.x, lerp3_of(uv.y, n00, n01), lerp3_of(uv.y, n10, n11));
        float ns_length = length_of(ns);
        if (ns_length > 0.0f) {
            s.ns = ns / ns_length;
            s.ng = face_forward(s.ng, s.ns);
            if (HAS(EFFECT_BUMP)) {
                s.dndu = unit_derivative(s.ns, ns_length, lerp3_of(uv.y, n10, n11) - lerp3_of(uv.y, n00, n01));
                s.dndv = unit_derivative(s.ns, ns_length, lerp3_of(uv.x, n01, n11) - lerp3_of(uv.x, n00, n10));
            }
        }
    }
    s.dpdu = dpdu * du_ds + dpdv * dv_ds;
    s.dpdv = dpdu * du_dt + dpdv * dv_dt;
    vec3 dndu = s.dndu;
    vec3 dndv = s.dndv;
    s.dndu = dndu * du_ds + dndv * dv_ds;
    s.dndv = dndu * du_dt + dndv * dv_dt;
}

// The ray's first hit on the patch; false (and s unchanged) if there is none.
FN bool bilinear_surface(uint geometry, uint primitive, vec3 o, vec3 d, INOUT(Surface) s) {
    float t;
    vec2 uv;
    if (!bilinear_hit(geometry, primitive, o, d, INFINITE_DISTANCE, t, uv)) return false;
    bilinear_fill(geometry, primitive, uv, s);
    s.distance = t;
    return true;
}

#endif

// Sampling of points on shapes from a reference point, with densities in solid angle (1/sr) at that point.
//
// A shape is sampled uniformly in the solid angle that it subtends if there is a closed form (whole spheres from
// outside, large triangles), else uniformly by area. Everything is exact under any affine transform: densities include
// the transform's Jacobian.
#ifndef LAMPYRIS_KERNEL_SHAPE_SAMPLING
#define LAMPYRIS_KERNEL_SHAPE_SAMPLING

struct ShapeSample {
    vec3 wi;  // unit direction from the reference point
    float distance;
    float pdf;  // 1/sr
    vec3 position;
    float offset;  // along the normal, to leave the rounding error of the surface
    vec3 ng;       // unit geometric normal, on the same side as Surface's
    vec2 uv;
};

// Converts a density per area to solid angle, at a distance with the given square.
FN float pdf_of_area(float pdf_area, float distance_squared, float cosine) {
    return pdf_area * distance_squared / max(abs(cosine), 1e-20f);
}

// Computes wi, distance and pdf from the position and a density per area; false if the reference point is on the shape
// or sees it edge-on.
FN bool shape_sample_from_area(vec3 ref_p, float pdf_area, INOUT(ShapeSample) s) {
    vec3 to_light = s.position - ref_p;
    float d2 = length_squared(to_light);
    if (!(d2 > 0.0f) || !is_finite(d2)) return false;
    s.distance = sqrt(d2);
    s.wi = to_light * (1.0f / s.distance);
    float cosine = dot3(s.ng, s.wi);
    if (cosine == 0.0f) return false;
    s.pdf = pdf_of_area(pdf_area, d2, cosine);
    return s.pdf > 0.0f && is_finite(s.pdf);
}

// The end of a shadow ray that reaches the light's surface at p along wi, over `distance`. It is outside of the surface
// by `offset`, as the origin of a ray from there would be, and by the rounding errors of the shadow ray itself (its
// direction, its length and the tracer's distances), which are proportional to its length.
CONST float SHADOW_ROUNDING = 16.0f * MACHINE_EPSILON;
FN vec3 shadow_end(vec3 p, float offset, vec3 ng, vec3 wi, float distance) {
    return origin_beyond(p, (offset + SHADOW_ROUNDING * distance) * ng, -wi);
}
// A light at a point, for instance in a corner of the scene, has no surface: use the ray's direction as its normal.
FN float point_offset(vec3 p, vec3 direction) { return way_out_length(p, MACHINE_EPSILON * abs(p), direction); }

// A point on a light, sampled by area: where photons start.
struct AreaSample {
    vec3 position;
    vec3 error;  // bound of the absolute rounding error of `position`, per coordinate
    vec3 ng;     // unit geometric normal, oriented as Surface's
    vec2 uv;
    float pdf;  // per area
};

// ---- Triangles -------------------------------------------------------------------------------------------------------

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

// ---- Quadrics --------------------------------------------------------------------------------------------------------

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

// ---- Bilinear patches ------------------------------------------------------------------------------------------------

// Area per step in u and v at the four corners, up to a common factor. On a plane patch it is bilinear in between, so
// that sampling (u, v) in proportion to it is uniform by area.
FN vec4 patch_stretch(IN(Patch) b) {
    vec4 areas = vec4(
        length_of_area(cross3(b.p10 - b.p00, b.p01 - b.p00)), length_of_area(cross3(b.p10 - b.p00, b.p11 - b.p10)),
        length_of_area(cross3(b.p11 - b.p01, b.p01 - b.p00)), length_of_area(cross3(b.p11 - b.p01, b.p11 - b.p10)));
    return areas * scale_to_one(max(max(areas.x, areas.y), max(areas.z, areas.w)));
}

// Density per area at (u, v).
FN float patch_pdf_area(IN(Patch) b, vec2 uv) {
    float stretch = length_of_area(cross3(patch_dpdu(b, uv.y), patch_dpdv(b, uv.x)));
    return stretch > 0.0f ? pdf_bilinear(uv, patch_stretch(b)) / stretch : 0.0f;
}

FN AreaSample sample_bilinear_area(uint geometry, uint primitive, vec2 u) {
    Patch b = load_patch(geometry, primitive);
    vec2 uv = sample_bilinear(u, patch_stretch(b));
    Surface surface;
    bilinear_fill(geometry, primitive, uv, surface);
    AreaSample s;
    s.position = surface.position;
    s.error = surface.error;
    s.ng = surface.ng;
    s.uv = surface.uv;
    s.pdf = patch_pdf_area(b, uv);
    return s;
}

FN bool sample_bilinear_light(uint geometry, uint primitive, vec3 ref_p, vec2 u, OUT(ShapeSample) s) {
    AreaSample place = sample_bilinear_area(geometry, primitive, u);
    s.position = place.position;
    s.offset = way_out_length(place.position, place.error, place.ng);
    s.ng = place.ng;
    s.uv = place.uv;
    return shape_sample_from_area(ref_p, place.pdf, s);
}

// The surface's uv may be vertex attributes, so the patch's own uv are computed again by intersecting the ray.
FN float pdf_bilinear_light(uint geometry, uint primitive, vec3 ref_p, vec3 position, vec3 ng, vec3 wi) {
    float d2 = length_squared(position - ref_p);
    float t;
    vec2 uv;
    if (!bilinear_hit_beyond(geometry, primitive, ref_p, wi, 0.999f * sqrt(d2), INFINITE_DISTANCE, t, uv)) return 0.0f;
    return pdf_of_area(patch_pdf_area(load_patch(geometry, primitive), uv), d2, dot3(ng, wi));
}

#endif

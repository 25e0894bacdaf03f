// Spheres, disks and cylinders, whole or in part (zmin, zmax, phimax), under any affine transform.
//
// In their own space, spheres are centred at the origin, disks are at z = height around the z axis, and cylinders are
// around the z axis; u = phi / phimax, v along z (disk: inwards), as in pbrt (4th edition, sections 6.2 to 6.4).
// Normals point outward (disk: +z).
#ifndef LAMPYRIS_KERNEL_QUADRIC
#define LAMPYRIS_KERNEL_QUADRIC

// Bound of the relative error of transforming a point to the quadric's space and back: two affine transforms (gamma_3
// each, pbrt section 6.8.6), whose matrices are rounded, too. A ray's origin within this bound of the surface counts as
// on it, so that rays that start on the surface do not hit it again.
FN float quadric_bound() { return gamma_bound(8.0f); }

// |rows| (|p|, 1): the rounding error of an affine transform of p is proportional to this.
FN vec3 transform_magnitude(vec4 r0, vec4 r1, vec4 r2, vec3 p) {
    return transform_point(abs(r0), abs(r1), abs(r2), abs(p));
}

// Angle about z in [0, 2 pi).
FN float quadric_phi(vec3 p) {
    float phi = atan2_of(p.y, p.x);
    return phi < 0.0f ? phi + TWO_PI : phi;
}

// Whether p (in the quadric's space) is on the part of the surface that zmin, zmax, phimax or the radii include.
FN bool quadric_has_point(uint kind, IN(Quadric) q, vec3 p) {
    if (kind == GEOMETRY_SPHERE) {
        if ((q.z_min > -q.radius && p.z < q.z_min) || (q.z_max < q.radius && p.z > q.z_max)) return false;
    } else if (kind == GEOMETRY_CYLINDER) {
        if (p.z < q.z_min || p.z > q.z_max) return false;
    } else {
        float x = p.x / q.radius;
        float y = p.y / q.radius;
        float r2 = x * x + y * y;
        if (r2 > 1.0f || r2 < sqr(q.inner_radius / q.radius)) return false;
    }
    return !(q.phi_max < TWO_PI) || quadric_phi(p) <= q.phi_max;
}

// The first hit with 0 < t < t_max, and its point in the quadric's space, moved onto the surface.
//
// Spheres and cylinders are intersected as a unit sphere (or circle) with a unit direction. The discriminant is that of
// Haines, Gunther and Akenine-Moeller, "Precision Improvements for Ray/Sphere Intersection" (Ray Tracing Gems, 2019,
// equation 5): 1 - l.l, where l is the point of the line nearest to the centre. It does not cancel for far or small
// spheres. One root is q, the other c / q, so that neither cancels (equations 8 and 9).
FN bool quadric_solve(uint geometry, vec3 set_origin, vec3 set_direction, float t_max, OUT(float) t, OUT(vec3) p) {
    GeometryRecord g = geometries[geometry];
    TransformRecord m = transforms[g.transform];
    uint kind = g.kind;
    t = 0.0f;
    p = vec3(0.0f);
    vec3 o = transform_point(m.from0, m.from1, m.from2, set_origin);
    vec3 d = transform_vector(m.from0, m.from1, m.from2, set_direction);
    vec3 o_error = quadric_bound() * transform_magnitude(m.from0, m.from1, m.from2, set_origin);
    if (kind == GEOMETRY_DISK) {
        if (d.z == 0.0f) return false;
        float height = g.quadric.height - o.z;
        t = height / d.z;
        if (abs(height) <= o_error.z || !(t > 0.0f && t < t_max)) return false;
        p = vec3(o.x + t * d.x, o.y + t * d.y, g.quadric.height);
        return quadric_has_point(kind, g.quadric, p);
    }
    float radius = g.quadric.radius;
    float use_z = kind == GEOMETRY_SPHERE ? 1.0f : 0.0f;  // the cylinder's equation has no z
    vec3 direction = vec3(d.x, d.y, d.z * use_z);
    float speed = length_of(direction);
    if (!(speed > 0.0f)) return false;
    direction = direction / speed;
    vec3 f = vec3(o.x, o.y, o.z * use_z) / radius;
    float b = -dot3(f, direction);
    vec3 l = f + b * direction;
    float discriminant = 1.0f - length_squared(l);
    if (!(discriminant >= 0.0f)) return false;
    float s = sqrt(discriminant);
    float q = b >= 0.0f ? b + s : b - s;
    if (q == 0.0f) return false;  // the ray touches the surface at its origin
    float f2 = length_squared(f);
    float c = f2 - 1.0f;
    // Far from the surface b and s do not cancel, and c / q could overflow.
    float other = abs(b) > 2.0f ? (b > 0.0f ? b - s : b + s) : c / q;
    // A root within its error of zero is the surface point at which the ray starts.
    vec3 f_error = vec3(o_error.x, o_error.y, o_error.z * use_z) / radius;
    float q_error = f_error.x + f_error.y + f_error.z + gamma_bound(4.0f) * abs(b);
    float c_error = 2.0f * dot3(abs(f), f_error) + gamma_bound(5.0f) * (f2 + 1.0f);
    float other_error = c_error / abs(q);
    bool q_first = q < other;
    float scale = radius / speed;
    for (int i = 0; i < 2; ++i) {
        bool take_q = (i == 0) == q_first;
        float root = take_q ? q : other;
        t = root * scale;
        if (!(root > (take_q ? q_error : other_error))) continue;
        if (!(t < t_max)) return false;
        vec3 unit_point = f + root * direction;
        unit_point = unit_point / length_of(unit_point);
        p = unit_point * radius;
        if (kind == GEOMETRY_CYLINDER) p.z = o.z + t * d.z;
        if (quadric_has_point(kind, g.quadric, p)) return true;
    }
    return false;
}

FN bool quadric_hit(uint geometry, vec3 o, vec3 d, float t_max, OUT(float) t) {
    vec3 p;
    return quadric_solve(geometry, o, d, t_max, t, p);
}

// Outward unit normal in the quadric's space.
FN vec3 quadric_outward(uint kind, IN(Quadric) q, vec3 p) {
    if (kind == GEOMETRY_SPHERE) return p / q.radius;
    if (kind == GEOMETRY_CYLINDER) return vec3(p.x / q.radius, p.y / q.radius, 0.0f);
    return vec3(0.0f, 0.0f, 1.0f);
}

// The geometric normal at p (quadric's space) in the space of the geometry's set. It is not of unit length: its length
// times |det| of the transform is the factor by which the transform stretches area at p.
FN vec3 quadric_set_normal(uint geometry, vec3 p) {
    GeometryRecord g = geometries[geometry];
    TransformRecord m = transforms[g.transform];
    vec3 n = transform_normal(m.from0, m.from1, m.from2, quadric_outward(g.kind, g.quadric, p));
    return (g.flags & GEOMETRY_FLIP) != 0u ? -n : n;
}

// Polar angles of a sphere's zmin and zmax.
FN vec2 sphere_theta_range(IN(Quadric) q) {
    return vec2(acos_of(clamp(q.z_min / q.radius, -1.0f, 1.0f)), acos_of(clamp(q.z_max / q.radius, -1.0f, 1.0f)));
}

FN vec2 quadric_uv(uint kind, IN(Quadric) q, vec3 p) {
    float u = min(quadric_phi(p) / q.phi_max, 1.0f);
    if (kind == GEOMETRY_SPHERE) {
        vec2 theta = sphere_theta_range(q);
        return vec2(u, (acos_of(p.z / q.radius) - theta.x) / (theta.y - theta.x));
    }
    if (kind == GEOMETRY_CYLINDER) return vec2(u, (p.z - q.z_min) / (q.z_max - q.z_min));
    float x = p.x / q.radius;
    float y = p.y / q.radius;
    return vec2(u, (1.0f - sqrt(x * x + y * y)) / (1.0f - q.inner_radius / q.radius));
}

// Position and rounding error, in the set's space, of the surface point p (quadric's space).
FN vec3 quadric_set_position(uint geometry, vec3 p, OUT(vec3) error) {
    GeometryRecord g = geometries[geometry];
    TransformRecord m = transforms[g.transform];
    vec3 own = gamma_bound(5.0f) * abs(p);
    if (g.kind == GEOMETRY_DISK) own = vec3(0.0f);
    if (g.kind == GEOMETRY_CYLINDER) own.z = 0.0f;
    error = transform_vector(abs(m.to0), abs(m.to1), abs(m.to2), own) +
            quadric_bound() * transform_magnitude(m.to0, m.to1, m.to2, p);
    return transform_point(m.to0, m.to1, m.to2, p);
}

// Texture coordinates and tangents of the surface at p (quadric's space), given the length of the normal in the set's
// space.
FN void quadric_fill_uv(uint geometry, vec3 p, float normal_length, INOUT(Surface) s) {
    GeometryRecord g = geometries[geometry];
    TransformRecord m = transforms[g.transform];
    uint kind = g.kind;
    float phi_max = g.quadric.phi_max;
    s.uv = quadric_uv(kind, g.quadric, p);

    float x = p.x;
    float y = p.y;
    float r = sqrt(x * x + y * y);
    if (r == 0.0f) {  // at a pole or a disk's centre phi is whatever we say, as long as dpdu and dpdv are not zero
        x = 1e-5f * g.quadric.radius;
        r = x;
    }
    vec3 dpdu = vec3(-phi_max * y, phi_max * x, 0.0f);
    vec3 dpdv;
    if (kind == GEOMETRY_SPHERE) {
        vec2 theta = sphere_theta_range(g.quadric);
        dpdv = (theta.y - theta.x) * vec3(p.z * x / r, p.z * y / r, -r);
    } else if (kind == GEOMETRY_CYLINDER) {
        dpdv = vec3(0.0f, 0.0f, g.quadric.z_max - g.quadric.z_min);
    } else {
        dpdv = vec3(x, y, 0.0f) * ((g.quadric.inner_radius - g.quadric.radius) / r);
    }
    s.dpdu = transform_vector(m.to0, m.to1, m.to2, dpdu);
    s.dpdv = transform_vector(m.to0, m.to1, m.to2, dpdv);
    if (HAS(EFFECT_BUMP) && kind != GEOMETRY_DISK) {
        float sign = (g.flags & GEOMETRY_FLIP) != 0u ? -1.0f : 1.0f;
        float curvature = sign / g.quadric.radius;
        vec3 dndu = transform_normal(m.from0, m.from1, m.from2, dpdu * curvature);
        vec3 dndv =
            kind == GEOMETRY_SPHERE ? transform_normal(m.from0, m.from1, m.from2, dpdv * curvature) : vec3(0.0f);
        s.dndu = unit_derivative(s.ng, normal_length, dndu);
        s.dndv = unit_derivative(s.ng, normal_length, dndv);
    }
}

// Fills in the surface at p (quadric's space), except for distance, ids, material and light.
FN void quadric_fill(uint geometry, vec3 p, INOUT(Surface) s) {
    s.position = quadric_set_position(geometry, p, s.error);
    vec3 n = quadric_set_normal(geometry, p);
    float n_length = length_of(n);
    s.ng = n / n_length;
    s.ns = s.ng;
    s.uv = vec2(0.0f);
    s.dpdu = vec3(0.0f);
    s.dpdv = vec3(0.0f);
    s.dndu = vec3(0.0f);
    s.dndv = vec3(0.0f);
    if (surface_needs_uv()) quadric_fill_uv(geometry, p, n_length, s);
}

// The ray's first hit on the quadric; false (and s unchanged) if there is none.
FN bool quadric_surface(uint geometry, vec3 o, vec3 d, INOUT(Surface) s) {
    float t;
    vec3 p;
    if (!quadric_solve(geometry, o, d, INFINITE_DISTANCE, t, p)) return false;
    quadric_fill(geometry, p, s);
    s.distance = t;
    return true;
}

#endif

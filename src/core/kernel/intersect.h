// Intersection of rays with surfaces: traces the ray, then recomputes distance and position from the primitive in
// shared code, so that results do not depend on the tracer.
#ifndef LAMPYRIS_KERNEL_INTERSECT
#define LAMPYRIS_KERNEL_INTERSECT

// Maximum number of masked or invisible surfaces that a ray may pass; more is an error.
CONST uint MAX_PASSED_SURFACES = 100000u;

// The point at which the ray hits the triangle (barycentrics as in Möller and Trumbore 1997), in the space of the
// geometry's set.
FN void triangle_surface(uint geometry, uint primitive, vec3 o, vec3 d, INOUT(Surface) s) {
    GeometryRecord g = geometries[geometry];
    uint base = g.first_index + 3u * primitive;
    uint i0 = indices[base];
    uint i1 = indices[base + 1u];
    uint i2 = indices[base + 2u];
    vec3 p0 = vertex_position(g.first_vertex + i0);
    vec3 p1 = vertex_position(g.first_vertex + i1);
    vec3 p2 = vertex_position(g.first_vertex + i2);
    vec3 e1 = p1 - p0;
    vec3 e2 = p2 - p0;
    vec3 n = cross3(e1, e2);
    float n2 = length_squared(n);
    float n_length = sqrt(n2);
    vec3 from = o - p0;
    vec3 side1 = e1;
    vec3 side2 = e2;
    float unscale = 1.0f;
    if (RARELY(!square_fits(n2))) {
        // Products of up to four lengths follow, so scale the longer edge to a length of about 1.
        float scale = scale_to_one(max(max_component(abs(e1)), max_component(abs(e2))));
        unscale = 1.0f / scale;
        side1 = scale * e1;
        side2 = scale * e2;
        from = scale * from;
        n = cross3(side1, side2);
        n_length = length_of_area(n);
    }
    vec3 q = cross3(d, side2);
    float det = -dot3(d, n);  // e1 . (d x e2)
    vec3 r = cross3(from, side1);
    float inverse = det != 0.0f ? 1.0f / det : 0.0f;
    // Clamped, because rounding may put the point just outside of the triangle.
    float u = dot3(from, q) * inverse;
    float v = dot3(d, r) * inverse;
    float b1 = clamp(u, 0.0f, 1.0f);
    float b2 = clamp(v, 0.0f, 1.0f - b1);
    float b0 = 1.0f - b1 - b2;
    s.distance = dot3(from, n) * inverse * unscale;
    s.position = b0 * p0 + b1 * p1 + b2 * p2;
    // On a triangle that is seen edge-on, the plane tells nothing about the distance.
    if (RARELY(b1 != u || b2 != v || det == 0.0f)) s.distance = max(dot3(s.position - o, d) / length_squared(d), 0.0f);
    s.error = gamma_bound(7.0f) * (abs(b0 * p0) + abs(b1 * p1) + abs(b2 * p2));
    s.ng = -unit(d);
    if (n_length > 0.0f) {
        float n_inverse = 1.0f / n_length;
        s.ng = n * n_inverse;
        s.error += (triangle_plane_error(side1, side2, b1, b2, n_inverse) * unscale) * abs(s.ng);
    }

    s.uv = vec2(0.0f);
    s.dpdu = vec3(0.0f);
    s.dpdv = vec3(0.0f);
    s.dndu = vec3(0.0f);
    s.dndv = vec3(0.0f);
    vec2 duv1 = vec2(0.0f);
    vec2 duv2 = vec2(0.0f);
    float duv_inverse = 0.0f;
    bool has_uv_map = false;
    if (surface_needs_uv()) {
        vec2 uv0 = vec2(0.0f, 0.0f);
        vec2 uv1 = vec2(1.0f, 0.0f);
        vec2 uv2 = vec2(1.0f, 1.0f);
        if ((g.flags & GEOMETRY_HAS_UVS) != 0u) {
            uint first = geometries[geometry].first_uv;
            uv0 = vertex_uv(first + i0);
            uv1 = vertex_uv(first + i1);
            uv2 = vertex_uv(first + i2);
        }
        s.uv = b0 * uv0 + b1 * uv1 + b2 * uv2;
        duv1 = uv1 - uv0;
        duv2 = uv2 - uv0;
        float duv_det = duv1.x * duv2.y - duv1.y * duv2.x;
        has_uv_map = abs(duv_det) >= 1e-9f;
        if (has_uv_map) {
            duv_inverse = 1.0f / duv_det;
            s.dpdu = (e1 * duv2.y - e2 * duv1.y) * duv_inverse;
            s.dpdv = (e2 * duv1.x - e1 * duv2.x) * duv_inverse;
            has_uv_map = max_component(abs(cross3(s.dpdu, s.dpdv))) > 0.0f;
        }
        if (!has_uv_map) {
            Frame frame = frame_from_z(s.ng);
            s.dpdu = frame.x;
            s.dpdv = frame.y;
        }
    }

    if (HAS(EFFECT_SMOOTH_NORMALS) && (g.flags & GEOMETRY_HAS_NORMALS) != 0u) {
        uint first = geometries[geometry].first_normal;
        vec3 n0 = vertex_normal(first + i0);
        vec3 n1 = vertex_normal(first + i1);
        vec3 n2 = vertex_normal(first + i2);
        vec3 ns = b0 * n0 + b1 * n1 + b2 * n2;
        float l2 = length_squared(ns);
        s.ns = l2 > 0.0f ? ns / sqrt(l2) : s.ng;
        s.ng = face_forward(s.ng, s.ns);
        if (HAS(EFFECT_BUMP) && has_uv_map) {
            vec3 dn1 = n1 - n0;
            vec3 dn2 = n2 - n0;
            s.dndu = (dn1 * duv2.y - dn2 * duv1.y) * duv_inverse;
            s.dndv = (dn2 * duv1.x - dn1 * duv2.x) * duv_inverse;
        }
    } else {
        if ((g.flags & GEOMETRY_FLIP) != 0u) s.ng = -s.ng;
        s.ns = s.ng;
    }
}

// Transforms a surface point from an instance's space to world space.
FN void surface_to_world(uint instance, INOUT(Surface) s) {
    TransformRecord m = instances[instance].transform;
    s.error = transform_error(m.to0, m.to1, m.to2, s.position, s.error);
    s.position = transform_point(m.to0, m.to1, m.to2, s.position);
    s.ng = unit(transform_normal(m.from0, m.from1, m.from2, s.ng));
    vec3 ns = transform_normal(m.from0, m.from1, m.from2, s.ns);
    float ns_length = length_of(ns);
    s.ns = face_forward(ns / ns_length, s.ng);
    s.dpdu = transform_vector(m.to0, m.to1, m.to2, s.dpdu);
    s.dpdv = transform_vector(m.to0, m.to1, m.to2, s.dpdv);
    if (HAS(EFFECT_BUMP)) {
        s.dndu = transform_normal(m.from0, m.from1, m.from2, s.dndu) / ns_length;
        s.dndv = transform_normal(m.from0, m.from1, m.from2, s.dndv) / ns_length;
    }
}

// The surface point of a hit of the traced ray. False if the shared code finds no hit: a tracer that transforms rays
// itself may see the rim of an instanced quadric one rounding error farther out.
FN bool surface_at(IN(Hit) hit, vec3 o, vec3 d, INOUT(Surface) s) {
    vec3 set_o = o;
    vec3 set_d = d;
    if (HAS(EFFECT_INSTANCES) && hit.instance != 0u) {
        TransformRecord m = instances[hit.instance].transform;
        set_o = transform_point(m.from0, m.from1, m.from2, o);
        set_d = transform_vector(m.from0, m.from1, m.from2, d);
    }
    uint kind = geometries[hit.geometry].kind;
    if (HAS(EFFECT_BILINEAR) && kind == GEOMETRY_BILINEAR) {
        if (!bilinear_surface(hit.geometry, hit.primitive, set_o, set_d, s)) return false;
    } else if (HAS(EFFECT_QUADRICS) && kind >= GEOMETRY_SPHERE) {
        if (!quadric_surface(hit.geometry, set_o, set_d, s)) return false;
    } else {
        triangle_surface(hit.geometry, hit.primitive, set_o, set_d, s);
    }
    if (HAS(EFFECT_INSTANCES) && hit.instance != 0u) surface_to_world(hit.instance, s);
    s.way = way_out(s.position, s.error, s.ng);
    GeometryRecord g = geometries[hit.geometry];
    s.instance = hit.instance;
    s.geometry = hit.geometry;
    s.primitive = hit.primitive;
    s.material = g.material;
    s.light = g.first_light == NONE ? NONE : g.first_light + hit.primitive;
    return true;
}

// Number of rays that this invocation has traced.
PRIVATE(uint, traced_rays, 1)

// What happens to a ray at a surface.
CONST uint SURFACE_STOPS = 0u;   // the ray ends here
CONST uint SURFACE_PASSES = 1u;  // masked, and this ray passes by random choice: another one might end here
CONST uint SURFACE_ABSENT = 2u;  // masked, and there is no surface at this point (alpha 0)

RARE_FN float masked_opacity(IN(Surface) s) {
    return clamp(surface_alpha(s.geometry, surface_texture_context(s)), 0.0f, 1.0f);
}

// The surface's opacity at the point: its alpha.
FN float surface_opacity(IN(Surface) s) {
    if (!HAS(EFFECT_ALPHA)) return 1.0f;
    if (geometries[s.geometry].alpha_texture == NONE && geometries[s.geometry].alpha >= 1.0f) return 1.0f;
    Surface masked = s;
    return masked_opacity(masked);
}

// A random choice, with a hash of the ray as the random number (as in pbrt).
RARE_FN uint masked_fate(float opacity, vec3 o, vec3 d) {
    if (opacity <= 0.0f) return SURFACE_ABSENT;
    uint h = hash_combine(hash_combine(floatBitsToUint(o.x), floatBitsToUint(o.y)), floatBitsToUint(o.z));
    h = hash_combine(hash_combine(h, floatBitsToUint(d.x)), hash_combine(floatBitsToUint(d.y), floatBitsToUint(d.z)));
    return unit_float(h) > opacity ? SURFACE_PASSES : SURFACE_STOPS;
}

FN uint surface_fate(float opacity, vec3 o, vec3 d) {
    if (!HAS(EFFECT_ALPHA) || opacity >= 1.0f) return SURFACE_STOPS;
    return masked_fate(opacity, o, d);
}

FN bool is_interface(IN(Surface) s) { return materials[s.material].kind == MATERIAL_INTERFACE; }

// The next surface point that the ray hits, even if it is masked and lets the ray pass; `fate` is one of SURFACE_*.
FN bool intersect_next(vec3 origin, vec3 direction, OUT(Surface) s, OUT(uint) fate) {
    Hit hit;
    traced_rays[0] += 1u;
    fate = SURFACE_ABSENT;
    if (!trace_closest(origin, direction, INFINITE_DISTANCE, hit)) return false;
    if (!surface_at(hit, origin, direction, s)) return false;
    fate = surface_fate(surface_opacity(s), origin, direction);
    return true;
}

// The first surface point that stops the ray: masked surfaces may let it pass, interfaces stop it. Directions are unit
// length. `origin` becomes the origin of the last ray: with it and the primitive in s, surface_at computes the same
// point again.
FN bool intersect_scene_from(INOUT(vec3) origin, vec3 direction, OUT(Surface) s) {
    float passed = 0.0f;
    Hit hit;
    for (uint i = 0u; i < MAX_PASSED_SURFACES; ++i) {
        traced_rays[0] += 1u;
        if (!trace_closest(origin, direction, INFINITE_DISTANCE, hit)) return false;
        if (!surface_at(hit, origin, direction, s)) return false;
        s.distance += passed;
        if (surface_fate(surface_opacity(s), origin, direction) == SURFACE_STOPS) return true;
        PATH_LOG(log_passes(s.position, s.distance, log_now[0].medium, LOG_PASS_MASK));
        passed = s.distance;
        origin = origin_beyond(s.position, s.way, direction);
    }
    REPORT_UNFINISHED();
    return false;
}

FN bool intersect_scene(IN(Ray) ray, OUT(Surface) s) {
    vec3 o = ray.origin;
    return intersect_scene_from(o, ray.direction, s);
}

// Passed instead of a shadow ray's first medium to ignore media.
CONST uint MEDIA_IGNORED = 0xffffffffu;

// Points the unit direction at `end`, and returns the distance to it. Returns 0 if `end` is no longer ahead, because
// only rounding errors were left of the distance.
FN float aim_at(vec3 o, vec3 end, INOUT(vec3) direction) {
    vec3 way = end - o;
    if (!(dot3(way, direction) > 0.0f)) return 0.0f;
    float distance = length_of(way);
    direction = way * (1.0f / distance);
    return distance;
}

// shadow_ray for scenes in which surfaces may let the ray pass.
RARE_FN bool shadow_ray_through(vec3 start_o, vec3 start_direction, float distance, vec3 end, uint start,
                                OUT(Spectrum) transmittance) {
    transmittance = Spectrum(1.0f);
    vec3 o = start_o;
    vec3 direction = start_direction;
    bool absorbs = HAS(EFFECT_MEDIUM) && start != MEDIA_IGNORED;
    uint medium = start;
    float left = distance;
    for (uint i = 0u; i < MAX_PASSED_SURFACES; ++i) {
        Hit hit;
        Surface s;
        traced_rays[0] += 1u;
        // Behind each surface, the offset origin is a little off the line, so the ray is aimed again.
        float t_max = distance < INFINITE_DISTANCE ? aim_at(o, end, direction) : INFINITE_DISTANCE;
        bool found = t_max > 0.0f && trace_closest(o, direction, t_max, hit) && surface_at(hit, o, direction, s);
        if (!found) {
            if (absorbs) transmittance *= medium_transmittance(medium, max(left, 0.0f));
            return false;
        }
        float opacity = surface_opacity(s);
        bool crosses = false;
        if (HAS(EFFECT_INTERFACE) && is_interface(s)) {
            crosses = surface_fate(opacity, o, direction) == SURFACE_STOPS;
        } else {
            if (opacity >= 1.0f) return true;
            // No random choice: it would be the same whenever the same ray is traced again.
            transmittance *= 1.0f - opacity;
        }
        if (absorbs) {
            transmittance *= medium_transmittance(medium, s.distance);
            if (crosses) medium = medium_behind(s, direction, medium);
        }
        o = origin_beyond(s.position, s.way, direction);
        if (distance < INFINITE_DISTANCE) left -= s.distance;
    }
    REPORT_UNFINISHED();
    return true;
}

// Whether anything opaque is between o and `end`, which is `distance` away along the unit direction. Both must be
// outside of the surfaces that they belong to, if any (shadow_end); with INFINITE_DISTANCE there is no end. If nothing
// opaque is between them, `transmittance` is what masked surfaces and media let through. `start` is the medium in which
// the ray starts.
FN bool shadow_ray(vec3 o, vec3 direction, float distance, vec3 end, uint start, OUT(Spectrum) transmittance) {
    if (HAS(EFFECT_ALPHA | EFFECT_INTERFACE) && RARELY(CALLED_FOR(EFFECT_ALPHA | EFFECT_INTERFACE))) {
        Spectrum through;
        bool occluded = shadow_ray_through(o, direction, distance, end, start, through);
        transmittance = through;
        return occluded;
    }
    traced_rays[0] += 1u;
    transmittance = Spectrum(1.0f);
    if (HAS(EFFECT_MEDIUM) && start != MEDIA_IGNORED) transmittance = medium_transmittance(start, distance);
    vec3 aimed = direction;
    float t_max = distance < INFINITE_DISTANCE ? aim_at(o, end, aimed) : INFINITE_DISTANCE;
    return t_max > 0.0f && trace_occluded(o, aimed, t_max);
}

// The visibility, from 0 to 1, of a point `distance` away from s along the unit direction, ignoring media. The distance
// counts from the ray's offset origin.
FN float scene_openness(IN(Surface) s, vec3 direction, float distance) {
    Spectrum transmittance;
    vec3 o = origin_beyond(s.position, s.way, direction);
    bool limited = distance < 1e18f;  // larger than any scene, and its square does not overflow
    vec3 end = limited ? o + distance * direction : vec3(0.0f);
    float reach = limited ? distance : INFINITE_DISTANCE;
    return shadow_ray(o, direction, reach, end, MEDIA_IGNORED, transmittance) ? 0.0f : transmittance[0];
}

// The fraction of light that reaches s from `end` (shadow_end), `distance` away along the unit direction. s was reached
// through `medium`.
FN Spectrum scene_transmittance(IN(Surface) s, vec3 direction, float distance, vec3 end, uint medium) {
    Spectrum transmittance;
    uint start = medium_behind(s, direction, medium);
    vec3 o = origin_beyond(s.position, s.way, direction);
    bool occluded = shadow_ray(o, direction, distance, end, start, transmittance);
    return occluded ? Spectrum(0.0f) : transmittance;
}

#endif

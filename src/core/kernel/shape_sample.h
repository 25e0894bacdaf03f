// Sampling of points on shapes from a reference point, with densities in solid angle (1/sr) at that point.
//
// A shape is sampled uniformly in the solid angle that it subtends if there is a closed form (whole spheres from
// outside, large triangles), else uniformly by area. Everything is exact under any affine transform: densities include
// the transform's Jacobian.
#ifndef LAMPYRIS_KERNEL_SHAPE_SAMPLE
#define LAMPYRIS_KERNEL_SHAPE_SAMPLE

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

#endif

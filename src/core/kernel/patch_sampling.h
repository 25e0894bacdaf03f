// Sampling of points on bilinear patches that emit (shape_sample.h).
#ifndef LAMPYRIS_KERNEL_PATCH_SAMPLING
#define LAMPYRIS_KERNEL_PATCH_SAMPLING

#include "core/kernel/shape_sample.h"

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

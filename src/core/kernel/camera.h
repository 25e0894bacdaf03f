// Cameras and pixel filters.
#ifndef LAMPYRIS_KERNEL_CAMERA
#define LAMPYRIS_KERNEL_CAMERA

// The primary ray through `raster` (in pixels of the full image; (0, 0) is its upper left corner). u_lens chooses the
// point on the lens. Perspective rays start at the lens, orthographic ones on the plane z = 0 of camera space.
FN Ray camera_ray(vec2 raster, vec2 u_lens) {
    CameraRecord camera = scene[0].camera;
    vec3 origin = vec3(0.0f);
    vec3 direction = vec3(0.0f, 0.0f, 1.0f);
    vec3 on_screen =
        vec3(camera.screen.x + raster.x * camera.screen.z, camera.screen.y + raster.y * camera.screen.w, 1.0f);
    if (camera.kind == CAMERA_ORTHOGRAPHIC) {
        origin = vec3(on_screen.x, on_screen.y, 0.0f);
    } else {
        direction = on_screen;
    }
    if (CALLED_FOR(EFFECT_DEPTH_OF_FIELD) && camera.lens_radius > 0.0f) {
        // All rays of one film point meet on the plane of focus (direction.z is 1).
        vec3 focus = origin + direction * camera.focal_distance;
        vec2 lens = sample_concentric_disk(u_lens);
        origin = origin + vec3(camera.lens_radius * lens.x, camera.lens_radius * lens.y, 0.0f);
        direction = focus - origin;
    }
    Ray ray;
    ray.origin = transform_point(camera.to0, camera.to1, camera.to2, origin);
    ray.direction = unit(transform_vector(camera.to0, camera.to1, camera.to2, direction));
    return ray;
}

// Filter tables are floats, stored as bits among the integers of `distributions`.
FN float filter_number(uint at) { return uintBitsToFloat(distributions[at]); }

// Samples one coordinate of a smooth filter with its table (layout.h, CameraRecord), and multiplies `sign` by the
// filter's sign.
//
// The filter is linear between the table's nodes. Its absolute value is sampled exactly, by inverting the quadratic CDF
// within a cell. u below 1/2 gives negative coordinates, so that stratified u stay stratified.
FN float sample_filter_table(uint table, uint count, float radius, float u, INOUT(float) sign) {
    float centred = 2.0f * u - 1.0f;
    float share = min(abs(centred), ONE_MINUS_EPSILON);
    uint cdf = table + count + 1u;
    // Searches from the guide's interval on. The first step has no branch, because its outcome is unpredictable.
    uint cell = uint(filter_number(cdf + count + 2u + uint(share * float(count))));
    cell += uint(cell + 1u < count && filter_number(cdf + cell + 1u) <= share);
    while (cell + 1u < count && filter_number(cdf + cell + 1u) <= share) cell += 1u;
    float a = filter_number(table + cell);
    float b = filter_number(table + cell + 1u);
    if (a + b < 0.0f) sign = -sign;
    // sample_linear at the share's relative position in the interval, (share - cdf) / |a + b|: the nodes are scaled for
    // this.
    float rest = share - filter_number(cdf + cell);
    float root = safe_sqrt(a * a + rest * (abs(b) - abs(a)));
    float x = min(rest / max(abs(a) + root, 1e-20f), ONE_MINUS_EPSILON);
    return copy_sign((float(cell) + x) * (radius / float(count)), centred);
}

// Offset from the pixel's centre, in pixels, with density |filter| / integral of |filter|. The weight's expected value
// is 1. It is negative in the filter's negative lobes, and 1 everywhere for filters without them (Ernst et al. 2006,
// "Filter Importance Sampling").
FN vec2 pixel_filter_sample(vec2 u, OUT(float) weight) {
    CameraRecord camera = scene[0].camera;
    weight = 1.0f;
    if (camera.filter_kind == PIXEL_FILTER_BOX) {
        return vec2((2.0f * u.x - 1.0f) * camera.filter_radius_x, (2.0f * u.y - 1.0f) * camera.filter_radius_y);
    }
    if (camera.filter_kind == PIXEL_FILTER_TRIANGLE)
        return vec2(sample_tent(u.x, camera.filter_radius_x), sample_tent(u.y, camera.filter_radius_y));
    uint count = camera.filter_intervals;
    uint table_x = camera.filter_tables;
    uint table_y = table_x + 3u * count + 3u;
    float x = sample_filter_table(table_x, count, camera.filter_radius_x, u.x, weight);
    float y = sample_filter_table(table_y, count, camera.filter_radius_y, u.y, weight);
    weight = weight * (filter_number(table_x + 2u * count + 2u) * filter_number(table_y + 2u * count + 2u));
    return vec2(x, y);
}

#endif

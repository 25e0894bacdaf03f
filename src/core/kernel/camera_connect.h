// Connections from points of the scene to the camera: what light paths need of it.
#ifndef LAMPYRIS_KERNEL_CAMERA_CONNECT
#define LAMPYRIS_KERNEL_CAMERA_CONNECT

// A connection to a point of the lens, which is chosen uniformly as camera_ray does.
struct CameraConnection {
    vec3 wi;         // unit direction towards the camera
    float distance;  // in scene units
    vec3 end;        // on the lens, or on the plane z = 0 of an orthographic camera
    vec2 raster;     // where the ray from there through the point crosses the picture (pixels)
    // Of a pixel, per unit of power that leaves the point towards the lens: 1 / (d^2 W), for the solid angle W of a pixel seen
    // from the lens point. For orthographic cameras 1 over the cross section of a pixel's beam. In both cases, the cosine
    // at the point is the caller's.
    float importance;
};

// CameraConnection::importance, for a point `distance` away; `stretch` is the length |M d| of camera_connect. Times the
// geometric cosine at the point, it is the density per area (1/m^2) with which a pixel's camera ray, whose film point is
// uniform in the pixel, hits the surface there.
FN float camera_importance(float stretch, float distance) {
    CameraRecord camera = scene[0].camera;
    float pixel = abs(camera.screen.z * camera.screen.w) * camera.volume;
    return camera.kind == CAMERA_ORTHOGRAPHIC ? stretch / pixel : stretch * sqr(stretch / distance) / pixel;
}

// The same, for a camera ray in the unit direction w that hits a point `distance` from its origin.
FN float camera_ray_importance(vec3 w, float distance) {
    // w = M d / |M d|, and d.z = 1.
    return camera_importance(1.0f / dot3(vec3(scene[0].camera.from2), w), distance);
}

// False if the camera cannot see p: it lies behind the lens, or in its plane.
//
// A ray has the camera-space direction d = (x, y, 1), where one pixel covers the area A = |screen.z screen.w| of the plane z = 1,
// so its solid angle is A |det M| / |M d|^3 for the linear part M of world-from-camera: A cos^3 without scaling. The beam
// of an orthographic pixel has the cross section A |det M| / |M d|.
FN bool camera_connect(vec3 p, vec2 u_lens, OUT(CameraConnection) c) {
    CameraRecord camera = scene[0].camera;
    vec3 local = transform_point(camera.from0, camera.from1, camera.from2, p);
    vec2 lens = vec2(0.0f);
    if (CALLED_FOR(EFFECT_DEPTH_OF_FIELD) && camera.lens_radius > 0.0f)
        lens = camera.lens_radius * sample_concentric_disk(u_lens);
    vec2 shift =
        lens / camera.focal_distance;  // of a ray at z = 1, since all rays of a film point meet on the plane of focus
    vec3 d;
    vec2 on_screen;
    vec3 start;
    if (!(local.z > 0.0f)) return false;
    if (camera.kind == CAMERA_ORTHOGRAPHIC) {
        d = vec3(-shift.x, -shift.y, 1.0f);
        start = local - local.z * d;
        on_screen = vec2(start.x, start.y) - lens;
    } else {
        start = vec3(lens.x, lens.y, 0.0f);
        d = (local - start) / local.z;
        on_screen = vec2(d.x, d.y) + shift;
    }
    c.raster =
        vec2((on_screen.x - camera.screen.x) / camera.screen.z, (on_screen.y - camera.screen.y) / camera.screen.w);
    c.end = transform_point(camera.to0, camera.to1, camera.to2, vec3(start.x, start.y, 0.0f));
    vec3 way = c.end - p;
    c.distance = length_of(way);
    if (!(c.distance > 0.0f)) return false;
    c.wi = way / c.distance;
    c.importance = camera_importance(length_of(transform_vector(camera.to0, camera.to1, camera.to2, d)), c.distance);
    return true;
}

// ---- The pixel filter ------------------------------------------------------------------------------------------------

// The filter at an offset (pixels) along one axis, scaled so that its integral is 1. Half-open: of all pixels about a place, a box
// of radius 1/2 contains it in one.
FN float filter_value(uint kind, uint table, uint count, float radius, float offset) {
    if (offset < -radius || offset >= radius) return 0.0f;
    if (kind == PIXEL_FILTER_BOX) return 0.5f / radius;
    float share = min(abs(offset) / radius, ONE_MINUS_EPSILON);
    if (kind == PIXEL_FILTER_TRIANGLE) return (1.0f - share) / radius;
    float place = share * float(count);
    uint cell = min(uint(place), count - 1u);
    float value = lerp_of(place - float(cell), filter_number(table + cell), filter_number(table + cell + 1u));
    // The table's nodes are scaled so that an interval of |filter| has the integral |a + b|, and all on one side of the centre 1.
    return value * (float(count) / radius) * filter_number(table + 2u * count + 2u);
}

// One coordinate of the pixel that a splat at `place` goes to, chosen with a probability proportional to |filter|: the same
// noise as filter importance sampling has, and one pixel to write to. `weight` is multiplied by the filter over the probability.
FN int splat_coordinate(uint kind, uint table, uint count, float radius, float place, float u, INOUT(float) weight) {
    int i = int(ceil(place - radius - 0.5f));
    int last = int(floor(place + radius - 0.5f));
    int chosen = i;
    float value = 0.0f;
    float sum = 0.0f;
    float rest = u;  // uniform, whatever was chosen so far
    for (; i <= last; ++i) {
        float h = filter_value(kind, table, count, radius, place - (float(i) + 0.5f));
        float size = abs(h);
        if (size == 0.0f) continue;
        float before = sum;
        sum += size;
        float point = rest * sum;
        if (point < size) {
            chosen = i;
            value = h;
            rest = point / size;
        } else {
            rest = min((point - size) / before, ONE_MINUS_EPSILON);
        }
    }
    if (i != last + 1) REPORT_UNFINISHED();
    weight = value < 0.0f ? -weight * sum : weight * sum;
    return chosen;
}

// The pixel (of the full picture, or beside it) that receives a splat at `raster`, from two uniform numbers; the expected value of
// `weight` over the choice is the filter's value at each pixel.
FN ivec2 splat_pixel(vec2 raster, vec2 u, OUT(float) weight) {
    CameraRecord camera = scene[0].camera;
    uint count = camera.filter_intervals;
    uint table_x = camera.filter_tables;
    uint table_y = table_x + 3u * count + 3u;
    weight = 1.0f;
    int x = splat_coordinate(camera.filter_kind, table_x, count, camera.filter_radius_x, raster.x, u.x, weight);
    int y = splat_coordinate(camera.filter_kind, table_y, count, camera.filter_radius_y, raster.y, u.y, weight);
    return ivec2(x, y);
}

// Whether a splat at `raster` may reach the picture.
FN bool splat_reaches(vec2 raster) {
    CameraRecord camera = scene[0].camera;
    return raster.x > -camera.filter_radius_x && raster.y > -camera.filter_radius_y &&
           raster.x < float(camera.resolution_x) + camera.filter_radius_x &&
           raster.y < float(camera.resolution_y) + camera.filter_radius_y;
}

#endif

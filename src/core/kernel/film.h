// Accumulation of samples in a pixel, and the mapping from invocation indices to pixels.
#ifndef LAMPYRIS_KERNEL_FILM
#define LAMPYRIS_KERNEL_FILM

// Consecutive indices are nearby pixels: strips of eight rows, traversed column by column, so that the rays of a block
// of work (CPU) or of a subgroup (GPU) are coherent.
FN uvec2 film_pixel_of(uint index, IN(FilmWindow) window) {
    uint strip = index / (8u * window.width);
    uint rest = index - strip * 8u * window.width;
    uint height = min(8u, window.height - strip * 8u);
    uint column = rest / height;
    return uvec2(column, strip * 8u + rest - column * height);
}

// The numbers of a pixel are found by its place on the full film, so that a window's pixels are those of the whole image.
FN uint film_pixel_number(uvec2 pixel, IN(FilmWindow) window) {
    return (window.y + pixel.y) * scene[0].camera.resolution_x + window.x + pixel.x;
}

FN float compensated_add(float sum, float value, INOUT(float) low) {
    float next = sum + value;
    float of_value = next - sum;
    low += (sum - (next - of_value)) +
           (value - of_value);  // exact, whichever operand is larger (Knuth, TAOCP 2, 4.2.2, theorem B)
    return next;
}

// Adds one sample, in linear Rec. 709. A sample whose radiance is not finite, or would make the sums overflow, is not
// added but counted, with the pass of the first one; then the result is false. Squares overflow sooner (above 1.8e19)
// and stay infinite: the variance is then unknown.
FN bool film_add(INOUT(FilmPixel) p, vec3 rgb, float weight, uint pass) {
    p.samples += 1u;
    vec3 value = rgb * weight;
    if (!is_finite3(p.sum + value)) {
        if (p.left_out == 0u) p.first_left_out = pass;
        p.left_out += 1u;
        return false;
    }
    p.sum.x = compensated_add(p.sum.x, value.x, p.low.x);
    p.sum.y = compensated_add(p.sum.y, value.y, p.low.y);
    p.sum.z = compensated_add(p.sum.z, value.z, p.low.z);
    p.weight = compensated_add(p.weight, weight, p.weight_low);
    p.squares.x += value.x * value.x;
    p.squares.y += value.y * value.y;
    p.squares.z += value.z * value.z;
    return true;
}

// Adds a sample's estimate of its own bias, for a sample that was added. If it is not finite, the pixel's bias is
// unknown.
FN void film_add_bias(INOUT(FilmBias) p, vec3 bias, float weight) {
    vec3 value = bias * weight;
    p.sum += vec4(value.x, value.y, value.z, 0.0f);
    p.squares += vec4(value.x * value.x, value.y * value.y, value.z * value.z, 0.0f);
}

// Features of the first surface that a camera ray hits: image channels for denoisers.
struct FirstHit {
    vec3 albedo;
    vec3 normal;     // shading normal
    float distance;  // from the ray's origin, in scene units
    float met;       // 1, or 0 if the ray hits nothing
};

FN FirstHit no_first_hit() {
    FirstHit f;
    f.albedo = vec3(0.0f);
    f.normal = vec3(0.0f);
    f.distance = 0.0f;
    f.met = 0.0f;
    return f;
}

FN FirstHit first_hit(IN(Surface) s, Spectrum albedo, float distance) {
    FirstHit f;
    f.albedo = rgb_of(albedo);
    f.normal = s.ns;
    f.distance = distance;
    f.met = 1.0f;
    return f;
}

FN void film_add_first_hit(INOUT(FilmPixel) p, IN(FirstHit) f) {
    p.albedo += f.albedo;
    p.hits += f.met;
    p.normal += f.normal;
    p.depth += f.distance;
}

// Converts radiance to the value that the film adds: applies the sensor's imaging ratio and the clamp
// `maxcomponentvalue`.
FN vec3 film_sensor(Spectrum radiance) {
    vec3 value = rgb_of(radiance) * scene[0].camera.imaging_ratio;
    float largest = max_component(value);
    float limit = scene[0].camera.max_component;
    return limit > 0.0f && largest > limit ? value * (limit / largest) : value;
}

// The log's end of camera path `path`: its radiance is a sample of the pixel with this weight.
RARE_FN void log_film_sample(uint path, Spectrum radiance, float weight) {
    log_sample(LOG_CAMERA_PATH, path, radiance, film_sensor(radiance) * weight, scene[0].camera.imaging_ratio * weight);
}

// One sample of a pixel: the camera ray, the pixel filter's weight, and a sampler at the first unused dimension.
struct CameraSample {
    Ray ray;
    float weight;
    uint pass;
    Sampler numbers;
};

// The i-th sample of the window's range, at a pixel of the window. The filter and the lens use CAMERA_DIMENSIONS random
// numbers, of the first CAMERA_GROUPS groups of joined pairs.
CONST uint CAMERA_DIMENSIONS = 4u;
CONST uint CAMERA_GROUPS = 2u;
FN CameraSample camera_sample(IN(FilmWindow) w, uvec2 pixel, uint i) {
    CameraSample s;
    uint x = w.x + pixel.x;
    uint y = w.y + pixel.y;
    s.pass = w.first_sample + i;
    s.numbers = sampler_begin(film_pixel_number(pixel, w), s.pass, w.seed, w.sampler_kind);
    vec2 offset = pixel_filter_sample(unit_floats(sample_bits_joined_2d_at(s.numbers, 0u, 0u)), s.weight);
    vec2 u_lens = vec2(0.5f);
    if (CALLED_FOR(EFFECT_DEPTH_OF_FIELD)) u_lens = unit_floats(sample_bits_joined_2d_at(s.numbers, 2u, 1u));
    s.ray = camera_ray(vec2(float(x) + 0.5f + offset.x, float(y) + 0.5f + offset.y), u_lens);
    s.numbers.dimension = CAMERA_DIMENSIONS;
    return s;
}

#endif

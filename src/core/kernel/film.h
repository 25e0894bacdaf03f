// What a rendering kernel adds up for each pixel, and which pixel an index means.
#ifndef LAMPYRIS_KERNEL_FILM
#define LAMPYRIS_KERNEL_FILM

// Consecutive indices lie close to each other: strips of eight rows, walked column by column, so that rays of one block of
// work (CPU) or of one subgroup (GPU) take similar ways.
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
           (value - of_value);  // exact, whichever is larger (Knuth, TAOCP 2, 4.2.2, theorem B)
    return next;
}

// Adds one sample, in linear Rec. 709. Radiance that is not finite, or that the sums cannot hold with what they have, is counted and located, not
// averaged in: then the result is false. Squares overflow sooner (above 1.8e19), and stay infinite: the variance is not known.
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

// Adds the estimate of its own bias of a sample that was added; not finite, it leaves the bias unknown.
FN void film_add_bias(INOUT(FilmBias) p, vec3 bias, float weight) {
    vec3 value = bias * weight;
    p.sum += vec4(value.x, value.y, value.z, 0.0f);
    p.squares += vec4(value.x * value.x, value.y * value.y, value.z * value.z, 0.0f);
}

// What the first surface that a camera ray meets is like: channels of the image, for denoisers.
struct FirstHit {
    vec3 albedo;
    vec3 normal;     // shading normal
    float distance;  // from where the ray starts, in scene units
    float met;       // 1, or 0 where the ray meets nothing
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

// What the film makes of radiance before it is added: the sensor's imaging ratio and the clamp of `maxcomponentvalue`.
FN vec3 film_sensor(Spectrum radiance) {
    vec3 value = rgb_of(radiance) * scene[0].camera.imaging_ratio;
    float largest = max_component(value);
    float limit = scene[0].camera.max_component;
    return limit > 0.0f && largest > limit ? value * (limit / largest) : value;
}

// One sample of a pixel: the camera's ray, the weight of the pixel filter, and the numbers from the first free dimension on.
struct CameraSample {
    Ray ray;
    float weight;
    uint pass;
    Sampler numbers;
};

// The i-th sample of the window's range, at a pixel of the window. The filter and the lens take CAMERA_DIMENSIONS.
CONST uint CAMERA_DIMENSIONS = 4u;
FN CameraSample camera_sample(IN(FilmWindow) w, uvec2 pixel, uint i) {
    CameraSample s;
    uint x = w.x + pixel.x;
    uint y = w.y + pixel.y;
    s.pass = w.first_sample + i;
    s.numbers = sampler_begin(film_pixel_number(pixel, w), s.pass, w.seed, w.sampler_kind);
    vec2 offset = pixel_filter_sample(sample_2d_at(s.numbers, 0u), s.weight);
    vec2 u_lens = vec2(0.5f);
    if (CALLED_FOR(EFFECT_DEPTH_OF_FIELD)) u_lens = sample_2d_at(s.numbers, 2u);
    s.ray = camera_ray(vec2(float(x) + 0.5f + offset.x, float(y) + 0.5f + offset.y), u_lens);
    s.numbers.dimension = CAMERA_DIMENSIONS;
    return s;
}

#endif

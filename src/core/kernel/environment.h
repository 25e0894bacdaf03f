// Light from infinitely far away that arrives from all directions: constant, or an image.
//
// Images are equal-area octahedral squares with the pole along +z of light space (pbrt, 4th edition, section 12.5.2), so a
// density on the square is 4 pi times the density in solid angle. Texels are taken as they are (no interpolation), as in
// pbrt, and the distribution that they are sampled from is constant on each: its density is exact.
#ifndef LAMPYRIS_KERNEL_ENVIRONMENT
#define LAMPYRIS_KERNEL_ENVIRONMENT

// The interval of a CDF of `count` intervals (count + 1 numbers from 0 to 1 in `distributions`) that u in [0, 1) falls into.
FN uint find_interval(uint first, uint count, float u) {
    // Without a branch on the comparison, which no processor could foresee.
    uint low = 0u;
    uint size = count;
    while (size > 1u) {
        uint half_size = size >> 1u;
        low += half_size & (0u - uint(distributions[first + low + half_size] <= u));
        size -= half_size;
    }
    return low;
}

// u's place in the interval, in [0, 1).
FN float place_in_interval(uint at, float u) {
    float low = distributions[at];
    return min((u - low) / (distributions[at + 1u] - low), ONE_MINUS_EPSILON);
}

// A piecewise constant density on the unit square (layout.h, LightRecord.ids of image lights).
FN vec2 sample_image_distribution(uint offset, uint width, uint height, vec2 u) {
    uint y = find_interval(offset, height, u.y);
    uint row = offset + height + 1u + y * (width + 1u);
    uint x = find_interval(row, width, u.x);
    return vec2((float(x) + place_in_interval(row + x, u.x)) / float(width),
                (float(y) + place_in_interval(offset + y, u.y)) / float(height));
}
FN float pdf_image_distribution(uint offset, uint width, uint height, vec2 st) {
    uint y = min(uint(max(st.y, 0.0f) * float(height)), height - 1u);
    uint x = min(uint(max(st.x, 0.0f) * float(width)), width - 1u);
    uint row = offset + height + 1u + y * (width + 1u) + x;
    return (distributions[row + 1u] - distributions[row]) *
           (distributions[offset + y + 1u] - distributions[offset + y]) * (float(width) * float(height));
}

// How much solid angle in light space a unit of solid angle about the world's direction d is.
FN float solid_angle_stretch(IN(TransformRecord) m, vec3 d) {
    float l = length_of(transform_vector(m.from0, m.from1, m.from2, d));
    return abs(determinant_of(m.from0, m.from1, m.from2)) / (l * l * l);
}

FN vec2 environment_st(IN(TransformRecord) m, vec3 direction) {
    return square_from_direction(unit(transform_vector(m.from0, m.from1, m.from2, direction)));
}

FN vec3 infinite_image_radiance(uint light, vec2 st) {
    vec4 texel = image_lookup(lights[light].data.z, st);
    return vec3(lights[light].emission) * vec3(texel);
}

// Without the probability of choosing the light.
FN float infinite_image_pdf(uint light, IN(TransformRecord) m, vec3 direction, vec2 st) {
    uvec4 ids = lights[light].ids;
    return pdf_image_distribution(ids.x, ids.y, ids.z, st) * INV_FOUR_PI * solid_angle_stretch(m, direction);
}

// Radiance from the infinite lights along a ray that leaves the scene in `direction` (unit length).
FN vec3 environment_radiance(vec3 direction) {
    vec3 sum = vec3(0.0f);
    if (!HAS(EFFECT_ENVIRONMENT)) return sum;
    for (uint light = 0u; light < scene[0].lights.y; ++light) {
        if (HAS(EFFECT_ENVIRONMENT_IMAGE) && lights[light].data.x == LIGHT_INFINITE_IMAGE) {
            TransformRecord m = transforms[lights[light].data.w];
            sum = sum + infinite_image_radiance(light, environment_st(m, direction));
        } else {
            sum = sum + vec3(lights[light].emission);
        }
    }
    return sum;
}

// Density (1/sr) with which light_sample finds the direction by choosing any infinite light.
FN float environment_pdf(vec3 direction) {
    float sum = 0.0f;
    if (!HAS(EFFECT_ENVIRONMENT)) return sum;
    for (uint light = 0u; light < scene[0].lights.y; ++light) {
        float pdf = pdf_uniform_sphere();
        if (HAS(EFFECT_ENVIRONMENT_IMAGE) && lights[light].data.x == LIGHT_INFINITE_IMAGE) {
            TransformRecord m = transforms[lights[light].data.w];
            pdf = infinite_image_pdf(light, m, direction, environment_st(m, direction));
        }
        sum = sum + lights[light].emission.w * pdf;
    }
    return sum;
}

// Samples one infinite light. Where there are several, the result is what all of them send from that direction, with the
// density of the mixture: that is also what a ray that finds the direction by chance sees and is weighted by.
FN bool environment_sample(uint light, vec2 u, OUT(vec3) direction, OUT(vec3) radiance, OUT(float) pdf) {
    radiance = vec3(lights[light].emission);
    pdf = pdf_uniform_sphere() * lights[light].emission.w;
    if (HAS(EFFECT_ENVIRONMENT_IMAGE) && lights[light].data.x == LIGHT_INFINITE_IMAGE) {
        TransformRecord m = transforms[lights[light].data.w];
        uvec4 ids = lights[light].ids;
        vec2 st = sample_image_distribution(ids.x, ids.y, ids.z, u);
        direction = unit(transform_vector(m.to0, m.to1, m.to2, direction_from_square(st)));
        // Radiance and density are those of one texel: read at st, not at st found again from the direction.
        radiance = infinite_image_radiance(light, st);
        pdf = infinite_image_pdf(light, m, direction, st) * lights[light].emission.w;
    } else {
        direction = sample_uniform_sphere(u);
    }
    if (scene[0].lights.y > 1u) {
        radiance = environment_radiance(direction);
        pdf = environment_pdf(direction);
    }
    return pdf > 0.0f;
}

#endif

// Infinite lights, which illuminate from all directions: constant, or an image.
//
// Images are equal-area octahedral squares with the pole along +z of light space (pbrt, 4th edition, section 12.5.2),
// so a density on the square is 4 pi times the density in solid angle. As in pbrt, texels are not interpolated. The
// sampling density is constant within each texel, and therefore exact.
#ifndef LAMPYRIS_KERNEL_ENVIRONMENT
#define LAMPYRIS_KERNEL_ENVIRONMENT

#include "core/kernel/distribution.h"

// Solid angle in light space per solid angle in world space, around the world's direction d.
FN float solid_angle_stretch(IN(TransformRecord) m, vec3 d) {
    float l = length_of(transform_vector(m.from0, m.from1, m.from2, d));
    return abs(determinant_of(m.from0, m.from1, m.from2)) / (l * l * l);
}

FN vec2 environment_st(IN(TransformRecord) m, vec3 direction) {
    return square_from_direction(unit(transform_vector(m.from0, m.from1, m.from2, direction)));
}

// The texel that a direction maps to.
FN uvec2 environment_texel(uint light, IN(TransformRecord) m, vec3 direction) {
    uint image = lights[light].image;
    uint width = images[image].width;
    uint height = images[image].height;
    vec2 st = environment_st(m, direction);
    return uvec2(min(uint(max(st.x, 0.0f) * float(width)), width - 1u),
                 min(uint(max(st.y, 0.0f) * float(height)), height - 1u));
}

FN Spectrum infinite_image_radiance(uint light, uvec2 texel) {
    ImageRecord image = images[lights[light].image];
    return lights[light].emission * spectrum_of_rgb(image_texel(image, int(texel.x), int(texel.y)));
}

// Where the light's density is in `distributions`. `weighted`: the sample is weighed against one of the BSDF, which finds
// what is not brighter than the mean well enough. That density leaves it out: it is in proportion to the radiance above the
// mean (Karlik et al. 2019, "MIS Compensation: Optimizing Sampling Techniques in Multiple Importance Sampling").
FN uint infinite_image_distribution(uint light, bool weighted) {
    ImageRecord image = images[lights[light].image];
    return lights[light].distribution + (weighted ? image_distribution_size(image.width, image.height) : 0u);
}

// Density (1/sr), without the probability of choosing the light.
FN float infinite_image_pdf(uint light, IN(TransformRecord) m, vec3 direction, uvec2 texel, bool weighted) {
    uint image = lights[light].image;
    return pdf_image_texel(infinite_image_distribution(light, weighted), images[image].width, images[image].height,
                           texel.x, texel.y) *
           INV_FOUR_PI * solid_angle_stretch(m, direction);
}

// Radiance from the infinite lights along a ray that leaves the scene in `direction` (unit length).
FN Spectrum environment_radiance(vec3 direction) {
    Spectrum sum = Spectrum(0.0f);
    if (!HAS(EFFECT_ENVIRONMENT)) return sum;
    for (uint light = 0u; light < scene[0].infinite_lights; ++light) {
        if (HAS(EFFECT_ENVIRONMENT_IMAGE) && lights[light].kind == LIGHT_INFINITE_IMAGE) {
            TransformRecord m = transforms[lights[light].transform];
            sum = sum + infinite_image_radiance(light, environment_texel(light, m, direction));
        } else {
            sum = sum + lights[light].emission;
        }
    }
    return sum;
}

// Density (1/sr) with which light_sample samples the direction by choosing any infinite light.
FN float environment_pdf(vec3 direction, bool weighted) {
    float sum = 0.0f;
    if (!HAS(EFFECT_ENVIRONMENT)) return sum;
    for (uint light = 0u; light < scene[0].infinite_lights; ++light) {
        float pdf = pdf_uniform_sphere();
        if (HAS(EFFECT_ENVIRONMENT_IMAGE) && lights[light].kind == LIGHT_INFINITE_IMAGE) {
            TransformRecord m = transforms[lights[light].transform];
            pdf = infinite_image_pdf(light, m, direction, environment_texel(light, m, direction), weighted);
        }
        sum = sum + lights[light].choice_probability * pdf;
    }
    return sum;
}

// Samples one infinite light. If there are several, the result is the radiance of all of them from that direction, with
// the density of the mixture: a ray that the BSDF samples in that direction sees the same radiance, and is weighted
// with the same density.
FN bool environment_sample(uint light, uvec2 u, bool weighted, OUT(vec3) direction, OUT(Spectrum) radiance,
                           OUT(float) pdf) {
    radiance = lights[light].emission;
    pdf = pdf_uniform_sphere() * lights[light].choice_probability;
    if (HAS(EFFECT_ENVIRONMENT_IMAGE) && lights[light].kind == LIGHT_INFINITE_IMAGE) {
        TransformRecord m = transforms[lights[light].transform];
        uint image = lights[light].image;
        TexelSample s = sample_image_distribution(infinite_image_distribution(light, weighted), images[image].width,
                                                  images[image].height, u);
        direction = unit(transform_vector(m.to0, m.to1, m.to2, direction_from_square(s.st)));
        // Radiance and density are those of the chosen texel: rounding may move the direction into the next one.
        uvec2 texel = uvec2(s.x, s.y);
        radiance = infinite_image_radiance(light, texel);
        pdf = infinite_image_pdf(light, m, direction, texel, weighted) * lights[light].choice_probability;
    } else {
        direction = sample_uniform_sphere(unit_floats(u));
    }
    if (scene[0].infinite_lights > 1u) {
        radiance = environment_radiance(direction);
        pdf = environment_pdf(direction, weighted);
    }
    return pdf > 0.0f;
}

#endif

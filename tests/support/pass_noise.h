// Noise of ppm's direct light: scenes whose pixels all have the same value, so that the spread over pixels is the error.
#pragma once

#include "support/one_of_each.h"
#include "support/runs.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace lampyris::test {

// 256 pixels that show a spot of a floor `size` wide, from straight above.
inline std::string spot_scene(double size, double height, const std::string& world) {
    return fmt::format(
        "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16 \"string filename\" \"x.exr\"\n"
        "PixelFilter \"box\" \"float xradius\" 0.5 \"float yradius\" 0.5\n"
        "Sampler \"independent\" \"integer pixelsamples\" 1\n"
        "LookAt 0 0 {1} 0 0 0 0 1 0\n"
        "Camera \"orthographic\" \"float screenwindow\" [ -{0} {0} -{0} {0} ]\n"
        "WorldBegin\n{3}{2}"
        "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \"point3 P\" [ -3 -3 0 3 -3 0 3 3 0 -3 3 0 ]\n",
        size / 2.0, height, world, one_of_each(-0.35));
}

// Two distant lights.
inline std::string two_suns(const std::string& material) {
    return spot_scene(
        0.2, 1.0,
        "LightSource \"distant\" \"rgb L\" [ 3.14159265 3.14159265 3.14159265 ] \"point3 from\" [ 1 0 1 ] "
        "\"point3 to\" [ 0 0 0 ]\n"
        "LightSource \"distant\" \"rgb L\" [ 3.14159265 3.14159265 3.14159265 ] \"point3 from\" [ -1 0 3 ] "
        "\"point3 to\" [ 0 0 0 ]\n" +
            material);
}

// More lights than are chosen by the number that also places the point on a light, a lamp with an area, and a mask before some
// of them. Everything but the floor is black: light arrives directly or not at all.
inline std::string many_lamps() {
    std::string world;
    for (int i = 0; i < 300; ++i)
        world += fmt::format(
            "LightSource \"distant\" \"rgb L\" [ {0} {0} {0} ] \"point3 from\" [ {1} {2} 3 ] "
            "\"point3 to\" [ 0 0 0 ]\n",
            0.002 * (1 + i % 3), -2.0 + 4.0 * (i % 20) / 20.0, -1.5 + 3.0 * (i / 20) / 15.0);
    world +=
        "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\n"
        "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [ 3 3 3 ]\n"
        "Shape \"trianglemesh\" \"integer indices\" [ 0 2 1 0 3 2 ] \"point3 P\" [ 1 -1 2 2 -1 2 2 1 2 1 1 2 ]\n"
        "AttributeEnd\n"
        "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \"point3 P\" [ 0.05 -2 1 2 -2 1 2 2 1 0.05 2 1 ] "
        "\"float alpha\" 0.4\n"
        "Material \"diffuse\" \"rgb reflectance\" [ 1 1 1 ]\n";
    return spot_scene(0.002, 0.5, world);
}

struct PassNoise {
    double mean = 0.0, mean_error = 0.0;
    double variance = 0.0;  // over pixels
    double estimated_relmse = 0.0, relmse = 0.0;
};

inline PassNoise noise_of(const std::string& scene, const RenderSettings& settings, double expected) {
    const Rendered image = render_text(scene, settings);
    Mean mean;
    PassNoise noise;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const double value = image.luminance(x, y);
            mean.add(value);
            noise.relmse += (value - expected) * (value - expected) / (expected * expected + 0.01);
        }
    noise.mean = mean.value();
    noise.mean_error = mean.error();
    noise.variance = mean.error() * mean.error() * double(mean.count());
    noise.relmse /= double(mean.count());
    noise.estimated_relmse = image.summary.estimated_relmse;
    return noise;
}

// Noise that is sampled again in each pass averages out: variance over pixels falls as 1 / passes, and the estimated error
// includes it. From 256 pixels, the logarithm of a variance is known to sqrt(2 / 255) = 0.089, that of a quotient to 0.125, and
// the estimate from 4 passes to 0.05. Limits are 4.9 standard errors of a normal distribution, which a test exceeds with a
// probability of 1e-6.
inline void expect_new_noise_in_each_pass(const std::string& backend, const std::string& scene, double expected,
                                          double expected_error) {
    RenderSettings settings = settings_of(backend, "ppm:maxdepth=8,photonsperiteration=64", 4, 0);
    const PassNoise few = noise_of(scene, settings, expected);
    settings.samples = 64;
    const PassNoise many = noise_of(scene, settings, expected);
    EXPECT_LT(std::abs(many.mean - expected), 4.9 * std::hypot(many.mean_error, expected_error))
        << many.mean << ", expected " << expected;
    EXPECT_GT(many.variance, 0.0);
    EXPECT_LT(std::abs(std::log(few.variance / many.variance / 16.0)), 4.9 * 0.125)
        << few.variance << " after 4 passes, " << many.variance << " after 64";
    EXPECT_LT(std::abs(std::log(few.estimated_relmse / few.relmse)), 4.9 * 0.105)
        << few.estimated_relmse << " estimated, " << few.relmse << " true, after 4 passes";
    EXPECT_LT(std::abs(std::log(many.estimated_relmse / many.relmse)), 4.9 * 0.089)
        << many.estimated_relmse << " estimated, " << many.relmse << " true, after 64 passes";
}

// A coat that reflects the sky, over a base that scatters; between them a medium. Each evaluation is the mean of a number of
// random walks.
inline std::string coated_floor(int walks) {
    return two_suns(fmt::format(
        "LightSource \"infinite\" \"rgb L\" [ 2 2 2 ]\n"
        "Material \"coateddiffuse\" \"rgb reflectance\" [ 0.6 0.6 0.6 ] \"float roughness\" 0 \"float thickness\" 0.3 "
        "\"rgb albedo\" [ 0.8 0.8 0.8 ] \"integer nsamples\" {}\n",
        walks));
}
// For the same two directions, like those to the suns, `path` repeats the same walk, so only many walks show it the coat
// itself.
inline void expect_new_noise_on_a_coat(const std::string& backend) {
    static const PassNoise reference = noise_of(coated_floor(1000), settings_of("cpu", "path:maxdepth=8", 8, 0), 1.0);
    expect_new_noise_in_each_pass(backend, coated_floor(4), reference.mean, reference.mean_error);
}

}  // namespace lampyris::test

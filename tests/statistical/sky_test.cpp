// Light samples of a sky leave what is not above its mean to the samples of the BSDF (environment.h).
#include "core/image/image_io.h"
#include "support/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace lampyris::test {
namespace {

// A white floor under a sky of 1, with suns at the zenith or at the nadir (four texels of 32 x 32 each).
Rendered floor_under_sky(float zenith, float nadir, const std::string& integrator) {
    constexpr int kSize = 32;
    Image sky(kSize, kSize, {"R", "G", "B"});
    std::fill(sky.pixels.begin(), sky.pixels.end(), 1.0f);
    for (int c = 0; c < 3; ++c) {
        for (const int x : {0, kSize - 1})
            for (const int y : {0, kSize - 1}) sky.at(x, y, c) = nadir;
        for (const int x : {kSize / 2 - 1, kSize / 2})
            for (const int y : {kSize / 2 - 1, kSize / 2}) sky.at(x, y, c) = zenith;
    }
    const std::string file = std::string(LAMPYRIS_BINARY_DIR) + "/sky_test_" + integrator.substr(0, 4) +
                             (zenith > 1 ? "_zenith" : "_nadir") + ".exr";
    write_image(file, sky);
    RenderSettings settings;
    settings.integrator = integrator;
    settings.samples = 16;
    settings.sampler = "independent";
    return render_text(
        "LookAt 0 1 0  0 0 0  0 0 1\nCamera \"orthographic\"\nFilm \"rgb\" \"integer xresolution\" 16 \"integer "
        "yresolution\" 16\nPixelFilter \"box\"\nWorldBegin\nAttributeBegin Rotate -90 1 0 0\nLightSource \"infinite\" \"string "
        "filename\" \"" +
            file +
            "\"\nAttributeEnd\nMaterial \"diffuse\" \"rgb reflectance\" [ 1 1 1 ]\nShape \"trianglemesh\" \"point3 P\" [ -2 0 "
            "-2 -2 0 2 2 0 2 2 0 -2 ] \"integer indices\" [ 0 1 2 0 2 3 ]\n",
        settings);
}

// The sun is below the floor, and takes all light samples: the BSDF's, in proportion to the cosine, find exactly 1 each. (With light
// samples in proportion to the radiance, pixels are off by 0.3.)
TEST(Sky, ASunThatIsHiddenMakesNoNoise) {
    const Rendered image = floor_under_sky(1, 1e4f, "path:maxdepth=1");
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) ASSERT_NEAR(image.luminance(x, y), 1.0, 1e-5) << x << ", " << y;
}

// Of methods that weigh nothing, no sample may be left out.
TEST(Sky, IsWholeForWhatDoesNotSampleTheBsdf) {
    for (const float nadir : {1.0f, 30.0f}) {
        const Rendered image = floor_under_sky(30, nadir, "sppm:maxdepth=1");
        double variance = 0.0;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) variance += image.luminance_variance(x, y) / (256.0 * 256.0);
        // On the square [-1, 1]^2, an area of 1 is a solid angle of pi; the cosine at (u, v) is 1 - (|u| + |v|)^2.
        constexpr double kHalf = 2.0 / 32;
        const double sun = 29 * (4 * kHalf * kHalf - 14.0 / 3 * kHalf * kHalf * kHalf * kHalf);
        EXPECT_NEAR(image.mean_luminance(), 1 + sun, 7 * std::sqrt(variance)) << nadir;  // 3e-12
        EXPECT_LT(7 * std::sqrt(variance), 0.15 * (1 + sun));
    }
}

}  // namespace
}  // namespace lampyris::test

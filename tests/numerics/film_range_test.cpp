// Radiance near the end of a float's range: the image stays finite, and samples that are lost are counted.
#include "support/runs.h"

#include <cmath>

namespace lampyris::test {
namespace {

class FilmRange : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, FilmRange, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

constexpr uint32_t kPasses = 16;

// A mirrorless floor that fills the lower half of the picture, under a sky that fills the upper one.
Rendered under_sky(const std::string& radiance, const std::string& backend, const std::string& integrator) {
    const std::string text =
        "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nPixelFilter \"box\"\nSampler "
        "\"independent\"\n"
        "LookAt 0 0 1  0 1 1  0 0 1\nCamera \"perspective\" \"float fov\" 60\nWorldBegin\n"
        "LightSource \"infinite\" \"rgb L\" [ " +
        radiance + " " + radiance + " " + radiance +
        " ]\nMaterial \"diffuse\" \"rgb reflectance\" [ .5 .5 .5 ]\n"
        "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \"point3 P\" [ -9 -9 0 9 -9 0 9 9 0 -9 9 0 ]\n";
    return render_text(text, settings_of(backend, integrator, kPasses, 0));
}

bool all_finite(const Image& image) {
    for (const float value : image.pixels)
        if (!std::isfinite(value)) return false;
    return true;
}

// The sum of four samples of 1e38 does not fit into a float: later samples are left out, counted, and located. The sky's pixels
// show the mean of the remaining ones, which is right.
TEST_P(FilmRange, SumsThatOverflowLeaveSamplesOut) {
    for (const auto& [radiance, kept] : {std::pair{"1e38", 3u}, std::pair{"3e38", 1u}}) {
        SCOPED_TRACE(radiance);
        const Rendered image = under_sky(radiance, GetParam(), "path:maxdepth=1");
        EXPECT_TRUE(all_finite(image.image));
        const float expected = std::stof(radiance);
        for (int x = 0; x < 8; ++x) {
            EXPECT_NEAR(image.value(x, 0, 0) / expected, 1.0f, 1e-6f);
            const kernel::FilmPixel& pixel = image.pixels[size_t(x)];
            EXPECT_EQ(pixel.samples, kPasses);
            EXPECT_EQ(pixel.left_out, kPasses - kept);
            EXPECT_EQ(pixel.first_left_out, kept);  // the first sample that is left out
        }
        EXPECT_GE(image.summary.non_finite, 4u * 8u * (kPasses - kept));
        EXPECT_GT(image.summary.unknown_errors, 0u);
        EXPECT_TRUE(std::isnan(image.summary.estimated_relmse));
    }
}

// Squares overflow earlier: above 1.8e19 the mean is right, but its error is unknown, which must not count as reaching a
// target.
TEST_P(FilmRange, SquaresThatOverflowLeaveTheErrorUnknown) {
    const Rendered dim = under_sky("1e17", GetParam(), "path:maxdepth=1");
    EXPECT_EQ(dim.summary.unknown_errors, 0u);
    EXPECT_TRUE(std::isfinite(dim.summary.estimated_relmse));
    const Rendered bright = under_sky("1e25", GetParam(), "path:maxdepth=1");
    EXPECT_TRUE(all_finite(bright.image));
    EXPECT_EQ(bright.summary.non_finite, 0u);
    EXPECT_EQ(bright.summary.unknown_errors, 64u);
    EXPECT_TRUE(std::isnan(bright.summary.estimated_relmse));
    // Except for the scale, both pictures are the same.
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            EXPECT_NEAR(bright.value(x, y, 0) / dim.value(x, y, 0) / 1e8f, 1.0f, 1e-5f) << x << ", " << y;
}

// The power of a photon overflows before the resulting radiance does: that, too, is counted instead of being dark.
TEST_P(FilmRange, PhotonsThatOverflowAreCounted) {
    const Rendered image =
        under_sky("1e37", GetParam(), "sppm:maxdepth=1,direct=photons,photonsperiteration=2000,radius=1");
    EXPECT_TRUE(all_finite(image.image));
    EXPECT_GT(image.summary.non_finite, 0u);
    EXPECT_NEAR(image.value(0, 0, 0) / 1e37f, 1.0f, 1e-6f);
}

// The sensor and its clamp apply to every integrator; without them, a sky seen from an open floor is 1.
TEST_P(FilmRange, EveryIntegratorGoesThroughTheSensor) {
    for (const auto& [film, expected] :
         {std::pair{"\"float maxcomponentvalue\" .25", .25f}, std::pair{"\"float iso\" 50", .5f}}) {
        SCOPED_TRACE(film);
        const std::string text = std::string("Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4 ") +
                                 film +
                                 "\nLookAt 0 0 1  0 .1 0  0 0 1\nCamera \"perspective\"\nWorldBegin\n"
                                 "LightSource \"infinite\"\nShape \"disk\" \"float radius\" 100\n";
        const Rendered image = render_text(text, settings_of(GetParam(), "ao:rays=1", 1, 0));
        for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 4; ++x) EXPECT_NEAR(image.value(x, y, 0), expected, 1e-6f) << x << ", " << y;
    }
}

}  // namespace
}  // namespace lampyris::test

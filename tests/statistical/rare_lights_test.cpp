// Light whose share of all samples is below the precision of a float still reaches the picture.
//
// False alarms: 9e-7 a mean (support/rare_lights.h), 6 means, fixed seeds.
#include "core/image/image_io.h"
#include "support/rare_lights.h"

#include <vector>

namespace lampyris::test {
namespace {

class RareLights : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, RareLights, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

// 129 lights, of which one is chosen by the place's number, and 32769, where each triangle has 1.5e-6 of the samples.
TEST_P(RareLights, ALampInPiecesIsTheLamp) {
    const double expected = mean_wall_radiance();
    for (const int n : {8, 128}) {
        SCOPED_TRACE(n);
        const std::string text = lamp_in_pieces(n);
        expect_mean_of_runs(text, GetParam(), "path:maxdepth=1", 128, expected, 0.0, 0.1);
        // A disk of radius 0.3 sees the mean over it; the curvature of the radiance is worth less than 1 %.
        expect_mean_of_runs(text, GetParam(), "sppm:maxdepth=1,direct=photons,photonsperiteration=100000,radius=0.3", 1,
                            expected, 0.01, 0.15);
    }
}

// A sky of 1 with one texel of 1e9 below the horizon, which the floor does not see: the floor is 1.
TEST_P(RareLights, ATexelTakesNoLightFromTheSky) {
    Image sky(64, 64, {"R", "G", "B"});
    std::fill(sky.pixels.begin(), sky.pixels.end(), 1.0f);
    for (int c = 0; c < 3; ++c) sky.pixels[size_t(3 * (64 + 1) + c)] = 1e9f;  // a corner of the square is -z
    const std::string file = failure_directory() + "/rare_lights_sky_" + name_of(GetParam()) + ".pfm";
    write_image(file, sky);
    const std::string text =
        "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nPixelFilter \"box\"\nSampler "
        "\"independent\"\n"
        "LookAt 0 0 1  0 0 0  0 1 0\nCamera \"orthographic\" \"float screenwindow\" [ -.5 .5 -.5 .5 ]\nWorldBegin\n"
        "LightSource \"infinite\" \"string filename\" \"" +
        file +
        "\"\nMaterial \"diffuse\" \"rgb reflectance\" [ 1 1 1 ]\n"
        "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \"point3 P\" [ -1 -1 0 1 -1 0 1 1 0 -1 1 0 ]\n";
    // Of path, there is no noise: light samples leave an even sky to those of the BSDF.
    expect_mean_of_runs(text, GetParam(), "path:maxdepth=1", 16, 1.0, 1e-6, 0.03);
    for (const char* integrator : {"sppm:maxdepth=1,direct=photons,photonsperiteration=100000,radius=0.2",
                                   "photon_map:maxdepth=1,direct=photons,photons=100000,radius=0.2"})
        expect_mean_of_runs(text, GetParam(), integrator, 1, 1.0, 0.0, 0.2);
}

}  // namespace
}  // namespace lampyris::test

// Random choices that a photon and an eye path both encounter: which material a mix shows, and whether a mask lets a ray pass.
// Each must be made only once per surface, not by both; tested by closed forms, and against path tracing.
//
// False alarms: each test has a rate of 1e-6 or less a tile or mean, at fixed seeds.
#include "support/choices_floor.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace lampyris::test {
namespace {

class PhotonChoices : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, PhotonChoices, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

// With photons as direct light. A disc of radius 0.008 lies in the pixels of 0.025 around it.
TEST_P(PhotonChoices, AreMadeOnce) {
    const std::string scene = floor_scene(GetParam() != "vulkan");
    for (const char* integrator :
         {"sppm:maxdepth=1,direct=photons,radius=0.008,photonsperiteration=40000,schedule=memoryless,alpha=1",
          "photon_map:maxdepth=1,direct=photons,radius=0.008,photons=400000",
          "photon_map:maxdepth=1,direct=photons,radius=0.016,nearest=40,photons=400000"}) {
        SCOPED_TRACE(integrator);
        expect_tiles(render_text(scene, settings_of(GetParam(), integrator, 32, 0)), 0.02);
    }
}

// The same scene by path tracing, which makes each choice once.
TEST(PhotonChoicesOfPaths, AreMadeOnce) {
    expect_tiles(render_text(floor_scene(true), settings_of("cpu", "path:maxdepth=1", 256, 0)), 0.02);
}

// Hit points of ppm are kept, and so are their choices: 256 of them per pixel, and few passes.
TEST_P(PhotonChoices, AreMadeOnceWhereHitPointsStay) {
    RenderSettings settings = settings_of(
        GetParam(), "ppm:maxdepth=1,direct=photons,radius=0.008,photonsperiteration=100000,schedule=memoryless,alpha=1",
        4, 0);
    settings.eye_samples = 256;
    expect_tiles(render_text(floor_scene(GetParam() != "vulkan"), settings), 0.025);
}

// A closed box of albedo 1/2 that emits 1 shows 2 everywhere (analytic/box-half), even if objects hang in it that absorb
// nothing: here boards of albedo 1, one half transparent by a mask, one half glass by a mix. Light arrives by bounces, of
// photons or of gather rays. 1 % is allowed for discs that extend past an edge, as there.
std::string box_scene() {
    std::string text =
        "LookAt 0 0 -0.9  0 0 1  0 1 0\n"
        "Camera \"perspective\" \"float fov\" 70\n"
        "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16 \"string filename\" \"x.exr\"\n"
        "PixelFilter \"box\" \"float xradius\" 0.5 \"float yradius\" 0.5\n"
        "Sampler \"independent\" \"integer pixelsamples\" 16\n"
        "Integrator \"path\" \"integer maxdepth\" 64\n"
        "WorldBegin\n"
        "MakeNamedMaterial \"white\" \"string type\" \"diffuse\" \"rgb reflectance\" [ 1 1 1 ]\n"
        "MakeNamedMaterial \"pane\" \"string type\" \"thindielectric\"\n"
        "MakeNamedMaterial \"both\" \"string type\" \"mix\" \"string materials\" [ \"white\" \"pane\" ]\n"
        "NamedMaterial \"both\"\n"
        "Shape \"trianglemesh\" \"point3 P\" [ -0.8 -0.8 0  -0.1 -0.8 0  -0.1 0.8 0  -0.8 0.8 0 ] "
        "\"integer indices\" [ 0 1 2 0 2 3 ]\n"
        "NamedMaterial \"white\"\n"
        "Shape \"trianglemesh\" \"point3 P\" [ 0.1 -0.8 0  0.8 -0.8 0  0.8 0.8 0  0.1 0.8 0 ] "
        "\"integer indices\" [ 0 1 2 0 2 3 ] \"float alpha\" 0.5\n"
        "AreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ]\n"
        "Material \"diffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5 ]\n";
    text = text + "AttributeBegin\n" + one_of_each(1.5) + "AttributeEnd\n";  // behind a wall
    for (const char* wall :
         {"-1 -1 -1  -1 -1 1  1 -1 1  1 -1 -1", "-1 1 -1  1 1 -1  1 1 1  -1 1 1", "-1 -1 -1  1 -1 -1  1 1 -1  -1 1 -1",
          "-1 -1 1  -1 1 1  1 1 1  1 -1 1", "-1 -1 -1  -1 1 -1  -1 1 1  -1 -1 1", "1 -1 -1  1 -1 1  1 1 1  1 1 -1"})
        text += fmt::format("Shape \"trianglemesh\" \"point3 P\" [ {} ] \"integer indices\" [ 0 1 2 0 2 3 ]\n", wall);
    return text;
}

TEST_P(PhotonChoices, KeepTheLightOfAClosedBox) {
    const std::string scene = box_scene();
    for (const char* integrator : {"sppm:maxdepth=64,radius=0.03,photonsperiteration=20000,schedule=memoryless",
                                   "photon_map:maxdepth=64,radius=0.04,photons=60000",
                                   "photon_map:maxdepth=64,radius=0.05,photons=20000,gather=2"}) {
        SCOPED_TRACE(integrator);
        Mean mean;
        for (uint32_t seed = 1; seed <= 6; ++seed) {
            RenderSettings settings = settings_of(GetParam(), integrator, 4, 0);
            settings.seed = seed;
            mean.add(render_text(scene, settings).mean_luminance());
        }
        // With a t distribution of 5 degrees of freedom, 1e-6 would need 22 standard errors, and detect nothing; so there is a
        // floor instead.
        EXPECT_LT(std::abs(mean.value() - 2.0), 0.02 + 5.0 * std::max(mean.error(), 0.004)) << mean.value();
        EXPECT_LT(mean.error(), 0.02);
    }
}

// Whether a surface is followed or gathered may depend on a texture finer than the radius, so photons are stored all over it.
// Compared with path tracing: a floor of metal under a sky, with a mirror's roughness on every other square.
TEST(PhotonChoicesOfRoughness, AreTheEyePathsAlone) {
    const std::string scene =
        "LookAt 0 0 4  0 0 0  0 1 0\n"
        "Camera \"perspective\" \"float fov\" 10\n"
        "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16 \"string filename\" \"x.exr\"\n"
        "Sampler \"independent\" \"integer pixelsamples\" 16\n"
        "Integrator \"path\" \"integer maxdepth\" 1\n"
        "WorldBegin\n"
        "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n"
        "Texture \"squares\" \"float\" \"checkerboard\" \"float uscale\" 200 \"float vscale\" 200 \"float tex1\" 0 "
        "\"float tex2\" 0.6\n"
        "Material \"conductor\" \"texture roughness\" \"squares\" \"bool remaproughness\" false\n"
        "Shape \"trianglemesh\" \"point3 P\" [ -2 -2 0  2 -2 0  2 2 0  -2 2 0 ] \"point2 uv\" [ 0 0  1 0  1 1  0 1 ] "
        "\"integer indices\" [ 0 1 2 0 2 3 ]\n";
    const double expected = render_text(scene, settings_of("cpu", "path:maxdepth=1", 512, 0)).mean_luminance();
    Mean mean;
    for (uint32_t seed = 1; seed <= 6; ++seed) {
        RenderSettings settings = settings_of(
            "cpu", "sppm:maxdepth=1,direct=photons,radius=0.05,photonsperiteration=100000,schedule=memoryless", 4, 0);
        settings.seed = seed;
        mean.add(render_text(scene, settings).mean_luminance());
    }
    // 2 % for the blur of the radius at the rim of the light's lobe.
    EXPECT_LT(std::abs(mean.value() - expected), 0.02 * expected + 5.0 * mean.error())
        << mean.value() << " +- " << mean.error();
    EXPECT_LT(mean.error(), 0.01 * expected);
}

}  // namespace
}  // namespace lampyris::test

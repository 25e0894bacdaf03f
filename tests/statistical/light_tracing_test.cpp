// Light tracing against path tracing, where every path's last vertex before the camera is one that a light path can connect:
// cameras, filters, crops, lights and materials.
//
// False alarms: each test compares blocks of pixels, with a total rate of 1e-6 per image by Sidak's correction, at fixed seeds. Power: a
// factor wrong by 5 % in half of the picture is more than eight standard errors of its mean.
#include "support/blocks.h"
#include "support/same_image.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

namespace lampyris::test {
namespace {

class LightTracing : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, LightTracing, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

// A floor, a ball and a wall that transmits, in the light of a lamp, a point and a sky.
std::string world() {
    return R"(
WorldBegin
LightSource "infinite" "rgb L" [ 0.1 0.15 0.2 ]
LightSource "point" "point3 from" [ 1 3 -1 ] "rgb I" [ 5 4 3 ]
Material "diffuse" "rgb reflectance" [ 0.6 0.5 0.4 ]
Shape "trianglemesh" "point3 P" [ -6 0 -6  6 0 -6  6 0 6  -6 0 6 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeBegin
  Material "diffuse" "rgb reflectance" [ 0.2 0.5 0.8 ]
  Translate 0 0.8 0
  Shape "sphere" "float radius" 0.8
AttributeEnd
AttributeBegin
  Material "diffusetransmission" "rgb reflectance" [ 0.3 0.3 0.3 ] "rgb transmittance" [ 0.4 0.2 0.2 ]
  Shape "trianglemesh" "point3 P" [ -2 0 1.5  -0.5 0 2.5  -0.5 2 2.5  -2 2 1.5 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 6 6 8 ]
  Translate -1 3 0.5
  Rotate 180 1 0 0
  Shape "trianglemesh" "point3 P" [ -0.5 0 -0.5  0.5 0 -0.5  0.5 0 0.5  -0.5 0 0.5 ] "integer indices" [ 0 2 1 0 3 2 ]
AttributeEnd
)";
}

struct View {
    const char* name;
    const char* text;
};
const View kViews[] = {
    {"perspective", "LookAt 0.5 2.5 -5  0 0.5 0  0.1 1 0 Camera \"perspective\" \"float fov\" 45 PixelFilter \"box\""},
    {"mirrored",
     "Scale -1 1 1 LookAt 0.5 2.5 -5  0 0.5 0  0 1 0 Camera \"perspective\" \"float fov\" 45 PixelFilter \"box\""},
    {"stretched",
     "Scale 1 2 0.5 LookAt 0.5 2.5 -5  0 0.5 0  0 1 0 Camera \"perspective\" \"float fov\" 60 PixelFilter \"box\""},
    {"screen window",
     "LookAt 0.5 2.5 -5  0 0.5 0  0 1 0 Camera \"perspective\" \"float fov\" 45 \"float screenwindow\" [ -0.2 1.1 -0.9 "
     "0.3 ]"},
    {"thin lens",
     "LookAt 0.5 2.5 -5  0 0.5 0  0 1 0 Camera \"perspective\" \"float fov\" 45 \"float lensradius\" 0.3 \"float "
     "focaldistance\" 4"},
    {"orthographic",
     "LookAt 0.5 2.5 -5  0 0.5 0  0 1 0 Scale 0.4 0.4 1 Camera \"orthographic\" PixelFilter \"triangle\""},
    {"orthographic lens",
     "LookAt 0.5 2.5 -5  0 0.5 0  0 1 0 Scale 0.4 0.4 1 Camera \"orthographic\" \"float lensradius\" 0.3 \"float "
     "focaldistance\" 4"},
    {"mitchell", "LookAt 0.5 2.5 -5  0 0.5 0  0 1 0 Camera \"perspective\" \"float fov\" 45 PixelFilter \"mitchell\""},
    {"sinc", "LookAt 0.5 2.5 -5  0 0.5 0  0 1 0 Camera \"perspective\" \"float fov\" 45 PixelFilter \"sinc\""},
    {"wide box",
     "LookAt 0.5 2.5 -5  0 0.5 0  0 1 0 Camera \"perspective\" \"float fov\" 45 PixelFilter \"box\" \"float xradius\" "
     "1.7 \"float yradius\" 0.8"},
};

TEST_P(LightTracing, SeesWhatEveryCameraSees) {
    for (const View& view : kViews) {
        const std::string text =
            std::string(view.text) + " Film \"rgb\" \"integer xresolution\" 48 \"integer yresolution\" 32 " + world();

        const uint32_t passes = GetParam() == "vulkan" ? 16 : 64;
        RenderSettings settings = settings_of(GetParam(), "light:maxdepth=3", passes, 0);
        const Rendered light = render_text(text, settings);
        settings.integrator = "path:maxdepth=3";
        settings.backend = "cpu";
        settings.samples = 256;
        expect_same_blocks(light, render_text(text, settings), 8,
                           std::string("camera ") + view.name + " " + GetParam());
    }
}

// Scenes whose first surfaces are not specular: light tracing misses nothing there.
TEST_P(LightTracing, AgreesWithPathTracing) {
    for (const char* name : {"analytic/box-half",         "analytic/lamp-cylinder",
                             "analytic/lamp-disk",        "analytic/lamp-distant",
                             "analytic/lamp-patch",       "analytic/lamp-point",
                             "analytic/lamp-rectangle",   "analytic/lamp-sky",
                             "analytic/lamp-sphere",      "analytic/lamp-spot",
                             "analytic/medium-shadow",    "analytic/sphere-point",
                             "analytic/texture-mean",     "analytic/thin-lens",
                             "reference/diffuse",         "reference/diffuse-transmission",
                             "reference/distant",         "reference/infinite-constant",
                             "reference/instances",       "reference/orthographic",
                             "reference/point-spot",      "reference/textures",
                             "reference/thin-lens",       "reference/conductor-rough",
                             "reference/dielectric-rough"}) {
        if (GetParam() == "vulkan" && name != std::string("reference/diffuse"))
            continue;  // SameOnEveryBackendAndThread
        const std::string file = kScenes + name + ".pbrt";
        std::stringstream read;
        read << std::ifstream(file).rdbuf();
        std::string text = read.str();
        // The filters of some scenes are points, which no light path ever meets. The default is a Gaussian.
        if (const size_t at = text.find("PixelFilter"); at != std::string::npos)
            text.erase(at, text.find('\n', at) - at);
        const std::string folder = file.substr(0, file.rfind('/'));
        RenderSettings settings = settings_of(GetParam(), "light:maxdepth=6,lightpaths=4000", 64, 24);
        const Rendered light = render_text(text, settings, folder);
        settings.integrator = "path:maxdepth=6";
        settings.backend = "cpu";
        settings.samples = 256;
        expect_same_blocks(light, render_text(text, settings, folder), 12, std::string(name) + " " + GetParam());
    }
}

// One path that differs by a rounding may reach several pixels: the share of docs/determinism.md, twice.
TEST(LightTracing, SameOnEveryBackendAndThread) {
    const RenderSettings settings = settings_of("cpu", "light:maxdepth=6", 3, 32);
    for (const char* name : {"reference/thin-lens", "analytic/medium-shadow"})
        expect_same_on_every_backend(name, settings, 0.996);
    for (const char* name : {"reference/diffuse", "reference/textures"}) expect_same_on_the_cpu(name, settings, 0.996);
}

// A crop is that part of the whole, to the bit; passes alone are those of the whole.
TEST_P(LightTracing, CropsArePartsOfTheWhole) {
    expect_crop_is_part_of_the_whole("reference/diffuse", settings_of(GetParam(), "light", 2, 0));
}

// A white plane under a white sky is 1, up to the picture's border and under filters with negative lobes.
TEST_P(LightTracing, ConstantsStayConstantToTheBorder) {
    for (const char* filter : {"box", "mitchell", "gaussian"}) {
        const std::string text = fmt::format(R"(
LookAt 0 3 0  0 0 0  0 0 1
Camera "orthographic"
PixelFilter "{}"
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
Material "diffuse" "rgb reflectance" [ 1 1 1 ]
Shape "trianglemesh" "point3 P" [ -2 0 -2  2 0 -2  2 0 2  -2 0 2 ] "integer indices" [ 0 2 1 0 3 2 ]
)",
                                             filter);
        const Rendered image = render_text(text, settings_of(GetParam(), "light:maxdepth=1,lightpaths=20000", 16, 0));
        const Block inside = block(image, 4, 4, 12, 12);
        EXPECT_LT(std::abs(inside.mean - 1), normal_threshold(kAlpha) * std::sqrt(inside.variance)) << filter;
        for (int edge = 0; edge < 4; ++edge) {
            const int a = edge % 2 ? 15 : 0;
            const Block border = edge < 2 ? block(image, a, 0, a + 1, 16) : block(image, 0, a, 16, a + 1);
            EXPECT_LT(std::abs(border.mean - 1), normal_threshold(kAlpha) * std::sqrt(border.variance))
                << filter << edge;
        }
    }
}

// What is seen through glass or in a mirror no light path reaches: exactly 0. The diffuse surface seen directly is right.
TEST_P(LightTracing, MirrorsAreBlack) {
    const Rendered image = render_file(kScenes + "analytic/mirror.pbrt", settings_of(GetParam(), "light", 4, 8));
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) EXPECT_EQ(image.luminance(x, y), 0.0);
}

}  // namespace
}  // namespace lampyris::test

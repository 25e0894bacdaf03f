// Methods with light paths in furnaces and through rough glass, in slices of any size, and where merging takes over.
//
// False alarms: kAlpha for each comparison, at fixed seeds.
#include "support/agreement.h"
#include "support/blocks.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

namespace lampyris::test {
namespace {

class LightPathLines : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, LightPathLines, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

// Mitsuba's bdpt failed here (issue 80 of its first version): paths of any length, which lose nothing, under a sky of 1.
TEST_P(LightPathLines, FurnacesShowOne) {
    for (const char* scene : {"furnace-diffuse", "furnace-glass", "furnace-mirror", "furnace-thin"}) {
        if (GetParam() == "vulkan" && scene != std::string("furnace-mirror")) continue;  // the same kernels
        for (const char* integrator : {"bdpt:maxdepth=1000", "vcm:maxdepth=1000"}) {
            SCOPED_TRACE(fmt::format("{} {}", scene, integrator));
            const Rendered image =
                render_file(scene_path(std::string("analytic/") + scene), settings_of(GetParam(), integrator, 32, 0));
            const Block all = whole(image);
            EXPECT_LT(std::abs(all.mean - 1.0), normal_threshold(kAlpha) * all.error() + 1e-4) << all.mean;
            EXPECT_LT(all.error(), 0.05);
        }
    }
}

// A slab of rough glass above a floor with a lamp beside it, seen from above and from inside the glass. Light paths that refract
// towards the camera carry importance, which is not divided by the square of the index where radiance is.
TEST_P(LightPathLines, RoughGlassIsTheSameFromBothSides) {
    if (GetParam() == "vulkan") return;  // the same kernels, which compile for a minute: backends_long_test has rough glass
    for (const char* eye : {"LookAt 0 3 -2  0 0 0  0 1 0", "LookAt 0 0.85 -0.5  0 0 0  0 1 0"}) {
        SCOPED_TRACE(eye);
        const std::string text = std::string(eye) + R"(
Camera "perspective" "float fov" 40
PixelFilter "box"
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 5 5 5 ]
Shape "trianglemesh" "point3 P" [ 1.2 2.2 -0.5  2 1.6 -0.5  2 1.6 0.5  1.2 2.2 0.5 ] "integer indices" [ 0 2 1 0 3 2 ]
AttributeEnd
Material "diffuse" "rgb reflectance" [ 0.7 0.7 0.7 ]
Shape "trianglemesh" "point3 P" [ -3 0 -3  3 0 -3  3 0 3  -3 0 3 ] "integer indices" [ 0 2 1 0 3 2 ]
Material "dielectric" "float eta" 1.5 "float roughness" 0.4
Shape "trianglemesh" "point3 P" [ -2 0.7 -2  2 0.7 -2  2 0.7 2  -2 0.7 2  -2 1 -2  2 1 -2  2 1 2  -2 1 2 ]
  "integer indices" [ 0 1 2 0 2 3  4 6 5 4 7 6  0 5 1 0 4 5  1 6 2 1 5 6  2 7 3 2 6 7  3 4 0 3 7 4 ]
)";
        RenderSettings settings = settings_of("cpu", "path:maxdepth=6", 1024, 0);
        const Rendered path = render_text(text, settings);
        settings.backend = GetParam();
        settings.samples = 128;
        settings.seed = 7;
        settings.integrator = "bdpt:maxdepth=6";
        expect_same_blocks(render_text(text, settings), path, 8, "bdpt " + GetParam());
        settings.integrator = "light:maxdepth=6,lightpaths=2000";
        expect_same_blocks(render_text(text, settings), path, 8, "light " + GetParam());
    }
}

// A pass may be divided as a device needs it: the same bits.
TEST_P(LightPathLines, SlicesChangeNothing) {
    for (const char* integrator : {"light", "bdpt", "vcm", "mlt:chains=64"}) {
        SCOPED_TRACE(integrator);
        RenderSettings settings = settings_of(GetParam(), integrator, 3, 16);
        const Rendered whole = render_file(scene_path("reference/diffuse"), settings);
        for (const uint32_t slice : {1u, 2u}) {
            settings.slice = slice;
            const Rendered sliced = render_file(scene_path("reference/diffuse"), settings);
            for (size_t i = 0; i < whole.pixels.size(); ++i)
                ASSERT_EQ(whole.pixels[i].sum, sliced.pixels[i].sum) << "pixel " << i << ", slices of " << slice;
        }
    }
}

// The more photons a pixel merges with, the more merging counts: where each merge sees thousands, vcm's weights are bpm's, and so is its
// picture, but for what photons never show (light that is seen directly).
TEST_P(LightPathLines, ManyMergesLeaveBpm) {
    if (GetParam() == "vulkan") return;  // mis_test holds its weights to the CPU's, to the bit
    const auto difference = [&](const char* radius) {
        RenderSettings settings =
            settings_of(GetParam(), fmt::format("bpm:maxdepth=3,lightpaths=20000,radius={},alpha=1", radius), 2, 12);
        const Rendered bpm = render_file(scene_path("analytic/box-half"), settings);
        settings.integrator = fmt::format("vcm:maxdepth=3,lightpaths=20000,radius={},alpha=1", radius);
        const Rendered vcm = render_file(scene_path("analytic/box-half"), settings);
        double sum = 0.0;
        for (int y = 0; y < 12; ++y)
            for (int x = 0; x < 12; ++x) sum += std::abs(vcm.luminance(x, y) - bpm.luminance(x, y)) / 144.0;
        return sum;
    };
    const double few = difference("0.01"), many = difference("1.0");
    EXPECT_LT(many, 0.02) << few;
    EXPECT_GT(few, 4.0 * many);
}

}  // namespace
}  // namespace lampyris::test

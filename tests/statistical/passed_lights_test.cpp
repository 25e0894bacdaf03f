// Area lights of constant alpha 0: they emit, and no ray hits them, as in pbrt-v4.
//
// False alarms: 9e-7 a mean (support/rare_lights.h), 8 means, fixed seeds.
#include "support/build_text.h"
#include "support/rare_lights.h"

#include <numbers>

namespace lampyris::test {
namespace {

class PassedLights : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, PassedLights, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

// A floor of albedo 1/2 in [-1, 1]^2, seen from above, through a lamp of radius 0.4 and radiance 1 at height 1.5.
std::string floor_under(const std::string& light, const std::string& alpha, double eye_height) {
    return fmt::format(
        "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nPixelFilter \"box\"\n"
        "Sampler \"independent\"\nLookAt 0 0 {}  0 0 0  0 1 0\n"
        "Camera \"orthographic\" \"float screenwindow\" [ -1 1 -1 1 ]\nWorldBegin\n"
        "Material \"diffuse\" \"rgb reflectance\" [ .5 .5 .5 ]\nShape \"trianglemesh\" \"integer "
        "indices\" [ 0 1 2 0 2 3 ] \"point3 P\" [ -3 -3 0 3 -3 0 3 3 0 -3 3 0 ]\nTranslate 0 0 1.5\n"
        "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\nAreaLightSource \"diffuse\" "
        "{}\nShape \"sphere\" \"float radius\" .4 {}\n",
        eye_height, light, alpha);
}

// A sphere's radiance fills the same solid angle as a disk with the same outline: E = pi r^2 / d^2 cos.
double floor_radiance() {
    constexpr int kGrid = 60;
    double sum = 0.0;
    for (int y = 0; y < kGrid; ++y)
        for (int x = 0; x < kGrid; ++x) {
            const glm::dvec3 to(1.0 - 2.0 * (x + 0.5) / kGrid, 1.0 - 2.0 * (y + 0.5) / kGrid, 1.5);
            sum += 0.5 * 0.16 * to.z / std::pow(glm::dot(to, to), 1.5);
        }
    return sum / (kGrid * kGrid);
}

// A texture that is 0 everywhere counts as that number.
TEST(PassedLight, IsToldByItsAlpha) {
    const auto flags = [](const std::string& alpha) {
        const BuiltText built = build_world(
            "Texture \"nothing\" \"float\" \"constant\" \"float value\" 0\n"
            "Texture \"half\" \"float\" \"constant\" \"float value\" 0.5\nAreaLightSource \"diffuse\"\nShape "
            "\"sphere\" " +
            alpha + "\n");
        EXPECT_TRUE(built.errors.empty()) << built.all_errors();
        return built.scene().lights.at(0).flags & kernel::LIGHT_PASSED;
    };
    EXPECT_EQ(flags("\"float alpha\" 0"), kernel::LIGHT_PASSED);
    EXPECT_EQ(flags("\"texture alpha\" \"nothing\""), kernel::LIGHT_PASSED);
    EXPECT_EQ(flags("\"texture alpha\" \"half\""), 0u);
    EXPECT_EQ(flags("\"float alpha\" 0.001"), 0u);
    EXPECT_EQ(flags(""), 0u);
}

TEST_P(PassedLights, SphereLightsTheFloorAndHidesNothing) {
    // Through the lamp's near side comes the light that its far side emits inwards: twice as much for a lamp with two sides. A
    // lamp with alpha 1/2, seen from below, adds half of the half that passes its near side.
    struct Lamp {
        const char *light, *alpha;
        double eye_height, sides;
    };
    for (const Lamp& lamp : {Lamp{"\"rgb L\" [ 1 1 1 ]", "\"float alpha\" 0", 3.0, 1.0},
                             Lamp{"\"bool twosided\" true", "\"float alpha\" 0", 3.0, 2.0},
                             Lamp{"\"bool twosided\" true", "\"float alpha\" .5", 1.0, 0.75}}) {
        SCOPED_TRACE(std::string(lamp.light) + lamp.alpha);
        const std::string text = floor_under(lamp.light, lamp.alpha, lamp.eye_height);
        const double expected = lamp.sides * floor_radiance();
        expect_mean_of_runs(text, GetParam(), "path:maxdepth=1", 32, expected, 0.0, 0.1);
        // The disk of a look-up averages over its area.
        expect_mean_of_runs(text, GetParam(), "sppm:maxdepth=1,direct=photons,photonsperiteration=20000,radius=0.1", 1,
                            expected, 0.005, 0.1);
        if (lamp.sides > 1.0)
            expect_mean_of_runs(text, GetParam(), "photon_map:maxdepth=1,direct=photons,photons=20000,radius=0.1", 1,
                                expected, 0.005, 0.1);
    }
}

// pbrt-v4's mean of this picture, from a file of sRGB numbers, is 0.045, to three decimals: a sphere lit by a lamp inside
// of the picture, which is not visible itself.
TEST_P(PassedLights, PictureIsPbrts) {
    const std::string text =
        "LookAt 0 0 5 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" 40\nFilm \"rgb\" \"integer xresolution\" 64 "
        "\"integer yresolution\" 64\nSampler \"independent\"\nWorldBegin\nAttributeBegin\nTranslate 0 3 2\n"
        "AreaLightSource \"diffuse\" \"rgb L\" [ 10 10 10 ]\nShape \"sphere\" \"float radius\" 0.5 \"float alpha\" 0\n"
        "AttributeEnd\nShape \"sphere\"\n";
    const Rendered picture = render_text(text, settings_of(GetParam(), "path:maxdepth=3", 32, 0));
    double sum = 0.0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) sum += double(srgb_from_linear(picture.value(x, y, 1)));
    EXPECT_NEAR(sum / (picture.width * picture.height), 0.045, 0.0005);
}

}  // namespace
}  // namespace lampyris::test

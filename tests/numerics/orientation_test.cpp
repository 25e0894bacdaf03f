// Which side of a quadric is outside under a mirroring transform (docs/scene-files.md): for glass and media, the side that
// pbrt-v4's rays see; for lamps, the side from which pbrt-v4 lights scenes, by every technique that finds light.
//
// The shapes are symmetric about the mirror's plane: scenes that must give the same image differ only in orientation, and use
// the same random numbers.
#include "support/paired.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lampyris::test {
namespace {

const std::string kView = R"(LookAt 0 0 -6  0 0 0  0 1 0
Camera "perspective" "float fov" 30
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
PixelFilter "box" "float xradius" 0.5 "float yradius" 0.5
Integrator "path" "integer maxdepth" 10
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [ 1 1 1 ] "rgb sigma_s" [ 0 0 0 ]
WorldBegin
LightSource "infinite" "rgb L" [ 0.1 0.1 0.1 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 1 1 1 ]
Translate 0.5 1.5 5
Shape "sphere" "float radius" 1.5
AttributeEnd
)";
const std::string kCylinder =
    "Rotate 90 0 1 0 Shape \"cylinder\" \"float radius\" 1 \"float zmin\" -2 \"float zmax\" 2\n";
const std::string kSphere = "Shape \"sphere\"\n";
const std::string kMirror = "Scale -1 1 1 ", kReverse = "ReverseOrientation ";

// An octahedron, facing out.
const std::string kMesh =
    "Shape \"trianglemesh\" \"point3 P\" [ 1 0 0 -1 0 0 0 1 0 0 -1 0 0 0 1 0 0 -1 ] \"integer indices\" "
    "[ 0 2 4 2 1 4 1 3 4 3 0 4 2 0 5 1 2 5 3 1 5 0 3 5 ]\n";

// Same images differ by 1e-6, others by a standard error of 1e-2.
constexpr double kSame = 1e-3;

class OrientationTest : public testing::TestWithParam<std::string> {
 protected:
    Rendered render(const std::string& text, const std::string& integrator = {}, uint32_t samples = 32) {
        RenderSettings settings;
        settings.backend = GetParam();
        settings.samples = samples;
        settings.seed = 3;
        settings.sampler = "independent";
        settings.integrator = integrator;
        settings.share_device = integrator.empty() || integrator.starts_with("path");
        return render_text(text, settings);
    }
    Rendered glass(const std::string& shape) {
        return render(kView + "Material \"dielectric\" \"float eta\" 1.5\n" + shape);
    }
    Rendered fog(const std::string& shape) {
        return render(kView + "Material \"interface\" MediumInterface \"fog\" \"\"\n" + shape);
    }
    // Except for rounding, and for a sample or two whose path rounding changes.
    static double difference(const Rendered& a, const Rendered& b) {
        const Paired found = compare_paired(a, b);
        return std::abs(found.relative_difference) + found.standard_error;
    }
    static bool same(const Rendered& a, const Rendered& b) { return difference(a, b) < kSame; }
};

TEST_P(OrientationTest, MirroredQuadricsScatterInsideOut) {
    for (const std::string& shape : {kCylinder, kSphere}) {
        const Rendered right = glass(shape), reversed = glass(kReverse + shape);
        EXPECT_FALSE(same(right, reversed)) << shape;
        EXPECT_TRUE(same(right, glass(kReverse + kMirror + shape))) << shape;
        EXPECT_TRUE(same(reversed, glass(kMirror + shape))) << shape;
        // A mirrored instance turns its contents round, and a mirrored mesh itself.
        EXPECT_TRUE(
            same(right, glass("ObjectBegin \"o\"\n" + shape + "ObjectEnd\n" + kMirror + "ObjectInstance \"o\"\n")))
            << shape;
    }
    const Rendered right = glass(kMesh), reversed = glass(kReverse + kMesh);
    EXPECT_FALSE(same(right, reversed));
    EXPECT_TRUE(same(right, glass(kMirror + kMesh)));
    EXPECT_TRUE(same(reversed, glass(kReverse + kMirror + kMesh)));
    EXPECT_TRUE(same(right, glass("ObjectBegin \"o\"\n" + kMesh + "ObjectEnd\n" + kMirror + "ObjectInstance \"o\"\n")));
}

TEST_P(OrientationTest, MediaAreWhereTheNormalSays) {
    const Rendered right = fog(kSphere), reversed = fog(kReverse + kSphere);
    EXPECT_FALSE(same(right, reversed));
    EXPECT_TRUE(same(right, fog(kReverse + kMirror + kSphere)));
    EXPECT_TRUE(same(reversed, fog(kMirror + kSphere)));
}

// A floor under a lamp: sampled lights with and without multiple importance sampling, rays that hit the lamp by chance, and
// photons.
TEST_P(OrientationTest, MirroredLampsShineAsTheOthers) {
    const auto lit = [](const std::string& lamp) {
        return "LookAt 0 0.8 0  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 60\n"
               "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\n"
               "Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\nMaterial \"diffuse\" \"rgb reflectance\" [ 0.5 "
               "0.5 0.5 ]\n"
               "Shape \"trianglemesh\" \"point3 P\" [ -2 0 -2 -2 0 2 2 0 2 2 0 -2 ] \"integer indices\" [ 0 1 2 0 2 3 "
               "]\n"
               "AreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ]\n" +
               lamp;
    };
    struct Lamp {
        const char* place;
        const char* shape;
        double from_inside;  // the share of light that a reversed lamp sends to the floor
    };
    for (const Lamp& lamp : {Lamp{"Translate 0 2 0 ", "Shape \"sphere\"\n", 0.0},
                             Lamp{"Translate 0 2 0 Rotate 90 1 0 0 ", "Shape \"disk\"\n", 0.0}}) {
        for (const char* integrator :
             {"path:maxdepth=1", "sppm:maxdepth=1,direct=photons,photonsperiteration=4000,radius=0.2"}) {
            const uint32_t samples = integrator[0] == 'p' ? 32 : 4;
            const std::string place = lamp.place, shape = lamp.shape;
            const Rendered right = render(lit(place + shape), integrator, samples);
            EXPECT_GT(right.mean_luminance(), 0.03) << shape;
            const Rendered mirrored = render(lit(place + kMirror + shape), integrator, samples);
            const Paired found = compare_paired(right, mirrored);
            // The samples are different ones: mirrored.
            EXPECT_LT(std::abs(found.relative_difference), 6.0 * found.standard_error + 1e-5) << shape << integrator;
            EXPECT_LT(found.standard_error, 0.03) << shape << integrator;
            for (const std::string& turned : {kReverse + place + shape, kReverse + place + kMirror + shape})
                EXPECT_EQ(render(lit(turned), integrator, samples).mean_luminance(), 0.0) << turned << integrator;
        }
        // Seen from the side that it lights, and from behind.
        const auto seen = [&](const std::string& how, const char* eye) {
            return render("LookAt " + std::string(eye) +
                              "  0 2 0  0 0 1\nCamera \"perspective\" \"float fov\" 2\n"
                              "Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4\n"
                              "Integrator \"path\" \"integer maxdepth\" 0\nWorldBegin\n"
                              "AreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ]\n" +
                              how,
                          {}, 1)
                .mean_luminance();
        };
        const std::string place = lamp.place, shape = lamp.shape;
        for (const std::string& mirror : {std::string(), kMirror}) {
            EXPECT_NEAR(seen(place + mirror + shape, "0 -3 0.1"), 1.0, 1e-6) << mirror << shape;
            EXPECT_EQ(seen(kReverse + place + mirror + shape, "0 -3 0.1"), 0.0) << mirror << shape;
            EXPECT_NEAR(seen(kReverse + place + mirror + shape, "0 2.5 0.1"), 1.0, 1e-6) << mirror << shape;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Backends, OrientationTest, testing::ValuesIn(usable_backends()), [](const auto& info) {
    std::string name = info.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

}  // namespace
}  // namespace lampyris::test

// Shadow rays end at their light, wherever the scene lies: no lamp occludes its own light, and no occluder in front of it is
// missed.
//
// Far from the world's origin, positions have an absolute error of eps |p|, eps half a unit in the last place. A lamp of size r
// is rounded to one of r +- 2 eps |p|, its height h to h +- 2 eps |p|, and the light on the floor below depends on their
// squares. So the image of a scene that was moved to p differs from that at the origin by at most kShare eps |p| / r, where r
// is the smallest length in it: the random numbers are the same, so there is no noise.
#include "support/paired.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lampyris::test {
namespace {

constexpr double kEps = 5.9604645e-8, kShare = 16.0;
constexpr int kPixels = 8;  // a station's
constexpr double kSmallest = 0.05;

// Each station is a floor, one unit wide, with a lamp 0.1 above it and a black hood over that. Light of lamps at other stations
// is negligible: they are small and far.
const std::vector<std::pair<const char*, std::string>>& lamps() {
    static const std::vector<std::pair<const char*, std::string>> all{
        {"triangles",
         "Shape \"trianglemesh\" \"point3 P\" [ -.05 .1 -.05 .05 .1 -.05 .05 .1 .05 -.05 .1 .05 ] \"integer indices\" "
         "[ 0 1 2 0 2 3 ]\n"},
        {"a tilted triangle",
         "Shape \"trianglemesh\" \"point3 P\" [ -.06 .08 -.05 .06 .12 -.04 .01 .11 .06 ] \"integer indices\" [ 0 1 2 "
         "]\n"},
        {"a patch", "Shape \"bilinearmesh\" \"point3 P\" [ -.05 .1 -.05 .05 .1 -.05 -.05 .1 .05 .05 .1 .05 ]\n"},
        {"a twisted patch",
         "Shape \"bilinearmesh\" \"point3 P\" [ -.05 .08 -.05 .05 .12 -.05 -.05 .12 .05 .05 .09 .05 ]\n"},
        {"a sphere", "Translate 0 .1 0 Shape \"sphere\" \"float radius\" .05\n"},
        {"a part of a sphere",
         "Translate 0 .1 0 Rotate 90 1 0 0 Shape \"sphere\" \"float radius\" .05 \"float zmin\" 0 \"float phimax\" "
         "300\n"},
        {"a disk", "Translate 0 .1 0 Rotate 90 1 0 0 Shape \"disk\" \"float radius\" .05\n"},
        {"a cylinder",
         "Translate 0 .1 0 Rotate 30 0 1 0 Shape \"cylinder\" \"float radius\" .05 \"float zmin\" -.06 \"float zmax\" "
         ".06\n"},
        {"a stretched sphere", "Translate 0 .12 0 Scale 1 .5 2 Shape \"sphere\" \"float radius\" .05\n"},
    };
    return all;
}

const std::string kFloor =
    "Shape \"trianglemesh\" \"point3 P\" [ -.5 0 -.5 -.5 0 .5 .5 0 .5 .5 0 -.5 ] \"integer indices\" [ 0 1 2 0 2 3 ]\n";
// All stations in a row along x, moved by `by`. An anchor at -by, out of sight, keeps the middle of the scene at the origin, so
// that the scene is not moved back (recentre.h). `covered`: a mask that all rays pass, and a drop of a medium without a
// surface, are in between.
std::string stations(std::array<double, 3> by, bool covered) {
    const int count = int(lamps().size()) + 1;
    const double half = count / 2.0;
    std::string text = fmt::format(
        "LookAt {:.17g} {:.17g} {:.17g}  {:.17g} {:.17g} {:.17g}  0 0 -1\n"
        "Camera \"orthographic\" \"float screenwindow\" [ {} {} -0.5 0.5 ]\n"
        "Film \"rgb\" \"integer xresolution\" {} \"integer yresolution\" {}\n"
        "PixelFilter \"box\" \"float xradius\" 0.5 \"float yradius\" 0.5\n"
        "Integrator \"path\" \"integer maxdepth\" 1\n"
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [ 4 4 4 ] \"rgb sigma_s\" [ 0 0 0 ]\n"
        "WorldBegin\n",
        by[0], by[1] + 5.0, by[2], by[0], by[1], by[2], -half, half, kPixels * count, kPixels);
    text += fmt::format(
        "AttributeBegin Translate {:.17g} {:.17g} {:.17g} Shape \"sphere\" \"float radius\" 1e-3 AttributeEnd\n",
        -by[0], -by[1] - 10.0, -by[2]);
    if (covered)
        text += "ObjectBegin \"floor\"\nMaterial \"diffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5 ]\n" + kFloor +
                "ObjectEnd\n";
    text += fmt::format("Translate {:.17g} {:.17g} {:.17g}\n", by[0], by[1], by[2]);
    for (int i = 0; i < count; ++i) {
        text +=
            fmt::format("AttributeBegin Translate {} 0 0\nMaterial \"diffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5 ]\n",
                        i + 0.5 - half);
        text += covered ? "AttributeBegin Scale 1 1 1 ObjectInstance \"floor\" AttributeEnd\n" : kFloor;
        text +=
            "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\n"
            "AttributeBegin Translate 0 .2 0 Rotate 90 1 0 0 Shape \"disk\" \"float radius\" .13 AttributeEnd\n";
        if (covered) {
            text +=
                "AttributeBegin Translate 0 .03 0 Rotate 90 1 0 0 Shape \"disk\" \"float radius\" .3 \"float alpha\" 0 "
                "AttributeEnd\n"
                "AttributeBegin Material \"interface\" MediumInterface \"fog\" \"\" Translate 0 .02 0 Scale 1 .2 1 "
                "Shape \"sphere\" \"float radius\" .07 AttributeEnd\n";
        }
        if (i < int(lamps().size()))
            text += "AreaLightSource \"diffuse\" \"rgb L\" [ 10 10 10 ]\n" + lamps()[size_t(i)].second;
        else
            text += "LightSource \"point\" \"rgb I\" [ 0.1 0.1 0.1 ] \"point3 from\" [ 0 .1 0 ]\n";
        text += "AttributeEnd\n";
    }
    return text;
}

class ShadowRayTest : public testing::TestWithParam<std::string> {
 protected:
    Rendered render(const std::string& text, const std::string& integrator = {}, uint32_t samples = 16) {
        RenderSettings settings;
        settings.backend = GetParam();
        settings.samples = samples;
        settings.seed = 7;
        settings.sampler = "independent";
        settings.integrator = integrator;
        settings.share_device = integrator.empty();
        return render_text(text, settings);
    }

    void expect_same(bool covered) {
        const Rendered here = render(stations({0, 0, 0}, covered));
        for (const auto& by : std::vector<std::array<double, 3>>{
                 {30, 0, 0}, {0, 30, 0}, {0, 0, 300}, {0, 1024, 0}, {1024, 0, 0}, {-700, 600, 500}}) {
            const double distance = std::hypot(by[0], by[1], by[2]);
            const double tolerance = kShare * kEps * distance / kSmallest;
            const Rendered there = render(stations(by, covered));
            for (int i = 0; i <= int(lamps().size()); ++i) {
                const Paired found = compare_paired(here, there, i * kPixels, 0, (i + 1) * kPixels, kPixels);
                const char* name = i < int(lamps().size()) ? lamps()[size_t(i)].first : "a point light";
                EXPECT_GT(found.mean, 0.002) << name;
                EXPECT_LT(std::abs(found.relative_difference), tolerance)
                    << name << " on " << GetParam() << ", moved by " << by[0] << " " << by[1] << " " << by[2];
            }
        }
    }
};

TEST_P(ShadowRayTest, LampsDoNotHideTheirOwnLight) { expect_same(false); }

TEST_P(ShadowRayTest, NorBehindMasksAndMedia) { expect_same(true); }

// The case that was reported: only 11 % of the light remained.
TEST_P(ShadowRayTest, ALampCloseToAFloor) {
    const auto scene = [](double height) {
        return fmt::format(
            "LookAt 0 {} 3  0 {} 0  0 1 0\nCamera \"perspective\" \"float fov\" 20\n"
            "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\n"
            "Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\nTranslate 0 {} 0\n"
            "Material \"diffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5 ]\n"
            "Shape \"trianglemesh\" \"point3 P\" [ -1 0 -1 -1 0 1 1 0 1 1 0 -1 ] \"integer indices\" [ 0 1 2 0 2 3 ]\n"
            "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [ 10 10 10 ]\n"
            "Shape \"trianglemesh\" \"point3 P\" [ -0.1 0.1 -0.1 0.1 0.1 -0.1 0.1 0.1 0.1 -0.1 0.1 0.1 ] \"integer "
            "indices\" [ 0 1 2 0 2 3 ]\nAttributeEnd\n",
            height + 0.5, height, height);
    };
    const Rendered here = render(scene(0)), there = render(scene(30));
    EXPECT_NEAR(compare_paired(here, there).relative_difference, 0.0, kShare * kEps * 30 / 0.1);
}

// A lamp above the corner of a triangle 10^3 and 10^4 times as large as the visible part, oblique to all axes. From a distant
// vertex, tracers find the plane with an error that does not show in the corner's own coordinates. 40 % of the light remained.
TEST_P(ShadowRayTest, TheCornersOfLargeTrianglesAreLit) {
    const auto scene = [](double size, int first) {
        const std::array<std::array<double, 3>, 3> corners{{{0, 0, 0}, {0, 0, size}, {size, 0, 0}}};
        std::string points;
        for (int i = 0; i < 3; ++i)
            for (const double x : corners[size_t((i + first) % 3)]) points += fmt::format("{} ", x);
        return fmt::format(
            "LookAt .05 .04 .05  .05001 0 .05  0 0 1\nRotate -33 1 2 .5\nCamera \"perspective\" \"float fov\" 60\n"
            "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\n"
            "Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\nRotate 33 1 2 .5\n"
            "Material \"diffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5 ]\n"
            "Shape \"trianglemesh\" \"point3 P\" [ {}] \"integer indices\" [ 0 1 2 ]\n"
            "AreaLightSource \"diffuse\" \"rgb L\" [ 10 10 10 ]\n"
            "Shape \"trianglemesh\" \"point3 P\" [ 0 .1 0 .1 .1 0 .1 .1 .1 ] \"integer indices\" [ 0 1 2 ]\n",
            points);
    };
    const Rendered small = render(scene(1, 0));
    EXPECT_GT(small.mean_luminance(), 0.5);
    for (const double size : {100.0, 1000.0})
        for (int first = 0; first < 3; ++first)
            EXPECT_NEAR(compare_paired(small, render(scene(size, first))).relative_difference, 0.0,
                        kShare * kEps * size / 0.1)
                << size << ", from corner " << first;
}

// A plate directly before the lamp, or directly above the floor, at a distance of 1e-5 of the ray's length: no light passes.
TEST_P(ShadowRayTest, NothingPassesAPlateCloseToEitherEnd) {
    for (const char* lamp :
         {"Shape \"trianglemesh\" \"point3 P\" [ -1 0 -1 1 0 -1 1 0 1 -1 0 1 ] \"integer indices\" [ "
          "0 1 2 0 2 3 ]\n",
          "Shape \"bilinearmesh\" \"point3 P\" [ -1 0 -1 1 0 -1 -1 0 1 1 0 1 ]\n",
          "Translate 0 1 0 Shape \"sphere\" \"float radius\" 1\n",
          "Rotate 90 1 0 0 Shape \"disk\" \"float radius\" 1\n"}) {
        for (const double plate : {99.999, 50.0, 0.001}) {
            const Rendered image = render(fmt::format(
                "LookAt 0 90 0  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 3\n"
                "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n"
                "Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\nMaterial \"diffuse\" \"rgb reflectance\" [ "
                "0.5 0.5 0.5 ]\n{}"
                "AttributeBegin Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\nTranslate 0 {} 0 Scale 99 1 99\n{}"
                "AttributeEnd\nAttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 1e4 1e4 1e4 ]\nTranslate 0 100 "
                "0\n{}"
                "AttributeEnd\n",
                kFloor, plate, kFloor, lamp));
            EXPECT_EQ(image.mean_luminance(), 0.0) << lamp << plate;
        }
    }
}

// A sphere that floats 1e-3 above a floor: most of its light comes along rays that graze it. The irradiance below a sphere of
// radius 1 at distance d is pi L / d^2.
TEST_P(ShadowRayTest, ASphereLightsWhatItTouches) {
    const double d = 1.001;
    const Rendered image =
        render(fmt::format("LookAt 1e-4 1e-4 0  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 1\n"
                           "Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4\n"
                           "Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\nMaterial \"diffuse\" \"rgb "
                           "reflectance\" [ 0.5 0.5 0.5 ]\n{}"
                           "AreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ]\nTranslate 0 {} 0 Shape \"sphere\"\n",
                           kFloor, d),
               {}, 256);
    // 4096 samples, whose relative deviation is 0.58 (of a cosine, uniform in the hemisphere), at 6 standard errors.
    EXPECT_NEAR(image.mean_luminance(), 0.5 / (d * d), 0.028);
}

// A lamp in a closed black box that fits it closely lights nothing: not even at its rims, along grazing rays, which would end
// beside the box's wall if they were shortened by an offset over a cosine.
TEST_P(ShadowRayTest, NothingLeavesAClosedBox) {
    const std::string cube =
        "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 -1 1 -1 -1 1 1 -1 -1 1 -1 -1 -1 1 1 -1 1 1 1 1 -1 1 1 ] \"integer "
        "indices\" [ 0 2 3 0 1 2 4 6 5 4 7 6 0 5 1 0 4 5 3 6 7 3 2 6 0 7 4 0 3 7 1 6 2 1 5 6 ]\n";
    const std::string can =
        "Shape \"cylinder\" AttributeBegin Translate 0 0 1 Shape \"disk\" AttributeEnd\n"
        "AttributeBegin Translate 0 0 -1 Rotate 180 1 0 0 Shape \"disk\" AttributeEnd\n";
    for (const std::string& shape : {cube, can}) {
        for (const std::string stretch : {".3 .3 .3", ".3 .3 1e-3"}) {
            const auto light_on_floor = [&](const std::string& box) {
                return render(
                           "LookAt 0 0.5 0  0 0 0  0 0 1\n"
                           "Camera \"orthographic\" \"float screenwindow\" [ -.4 .4 -.4 .4 ]\n"
                           "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\n"
                           "Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\n"
                           "Material \"diffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5 ]\n" +
                               kFloor +
                               "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\n"
                               "Translate 0 1 0 Rotate 31 1 2 3 Scale " +
                               stretch + "\n" + box +
                               "AreaLightSource \"diffuse\" \"rgb L\" [ 1e9 1e9 1e9 ] \"bool twosided\" true\n"
                               "Scale .99 .99 .99\n" +
                               shape,
                           {}, 256)
                    .mean_luminance();
            };
            EXPECT_GT(light_on_floor(""), 1e6) << shape << stretch;
            EXPECT_EQ(light_on_floor(shape), 0.0) << shape << stretch;
        }
    }
}

// Under a ceiling at height 0.99, directions within acos(0.99) hit it before distance 1: cosine-weighted, a share of 1 -
// 0.99^2. Beyond distance 1, none.
TEST_P(ShadowRayTest, AmbientOcclusionSeesToItsEnd) {
    const auto seen = [&](double ceiling) {
        return render(fmt::format("LookAt 0 0.5 0  0 0 0  0 0 1\n"
                                  "Camera \"orthographic\" \"float screenwindow\" [ -.01 .01 -.01 .01 ]\n"
                                  "Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4\nWorldBegin\n{}"
                                  "Translate 0 {} 0 Scale 99 1 99\n{}",
                                  kFloor, ceiling, kFloor),
                      "ao:distance=1,rays=64", 16)
            .mean_luminance();
    };
    // 16384 rays, at 6 standard errors.
    EXPECT_NEAR(seen(0.99), 0.99 * 0.99, 6.0 * std::sqrt(0.02 / 16384));
    EXPECT_EQ(seen(1.00001), 1.0);
}

INSTANTIATE_TEST_SUITE_P(Backends, ShadowRayTest, testing::ValuesIn(usable_backends()), [](const auto& info) {
    std::string name = info.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

}  // namespace
}  // namespace lampyris::test

// From a scene's text to its arrays: orientation, transforms, order, and which directive needs which effect.
#include "core/image/image_io.h"
#include "support/build_text.h"
#include "support/temporary_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace lampyris {
namespace {

using namespace kernel;

const char* kTriangle = "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 2 ]\n";

TEST(BuildScene, CornellBoxInSmall) {
    const BuiltText text = build_text(R"(
Integrator "path" "integer maxdepth" 65
Transform [ 1 0 0 0 0 1 0 0 0 0 -1 0 0 -1 6.8 1 ]
Sampler "sobol" "integer pixelsamples" 64
PixelFilter "triangle" "float xradius" 1 "float yradius" 1
Film "rgb" "string filename" "box.png" "integer yresolution" 512 "integer xresolution" 1024
Camera "perspective" "float fov" 19.5
WorldBegin
MakeNamedMaterial "Wall" "string type" "diffuse" "rgb reflectance" [ 0.63 0.065 0.05 ]
NamedMaterial "Wall"
Shape "trianglemesh" "point2 uv" [ 0 0 1 0 1 1 0 1 ] "normal N" [ 0 1 0 0 1 0 0 1 0 0 1 0 ]
    "point3 P" [ -1 0 -1 -1 0 1 1 0 1 1 0 -1 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 17 12 4 ]
Shape "trianglemesh" "point3 P" [ -1 2 -1 1 2 -1 1 2 1 ] "integer indices" [ 0 1 2 ]
AttributeEnd
)");
    ASSERT_EQ(text.all_errors(), "");
    const Scene& scene = text.scene();
    ASSERT_EQ(scene.geometries.size(), 2u);
    EXPECT_EQ(scene.geometries[0].kind, GEOMETRY_TRIANGLES);
    EXPECT_EQ(scene.geometries[0].flags, GEOMETRY_HAS_NORMALS | GEOMETRY_HAS_UVS);
    EXPECT_EQ(scene.geometries[0].first_index, 0u);
    EXPECT_EQ(scene.geometries[0].first_vertex, 0u);
    EXPECT_EQ(scene.geometries[0].primitive_count, 2u);
    EXPECT_EQ(scene.geometries[0].first_light, NONE);
    EXPECT_EQ(scene.geometries[1].kind, GEOMETRY_TRIANGLES);
    EXPECT_EQ(scene.geometries[1].flags, 0u);
    EXPECT_EQ(scene.geometries[1].first_index, 6u);
    EXPECT_EQ(scene.geometries[1].first_vertex, 4u);
    EXPECT_EQ(scene.geometries[1].first_normal, NONE);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.geometries[1].first_light, 0u);
    EXPECT_EQ(scene.lights[0].kind, LIGHT_TRIANGLE);
    EXPECT_EQ(scene.lights[0].emission, Spectrum(17.0f, 12.0f, 4.0f));
    EXPECT_EQ(scene.lights[0].choice_probability, 1.0f);
    EXPECT_FLOAT_EQ(scene.lights[0].area, 2.0f);
    EXPECT_EQ(scene.positions.size(), 7u * 3u + 4u);
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].color0, Spectrum(0.63f, 0.065f, 0.05f));
    EXPECT_EQ(scene.width(), 1024u);
    EXPECT_EQ(text.built.settings.integrator.type, "path");
    EXPECT_EQ(text.built.settings.samples_per_pixel, 64);
    EXPECT_EQ(text.built.settings.sampler, "sobol");
    EXPECT_EQ(text.built.settings.output, "box.png");
    // The field of view is that of the shorter side, here the height.
    const float half = std::tan(19.5f * std::numbers::pi_v<float> / 360.0f);
    EXPECT_NEAR(scene.record.camera.screen.y, half, 1e-6f);
    EXPECT_NEAR(scene.record.camera.screen.x, -2.0f * half, 1e-6f);
    EXPECT_NEAR(scene.record.camera.screen.w, -2.0f * half / 512.0f, 1e-8f);
    EXPECT_EQ(scene.effects.mask(), EFFECT_SMOOTH_NORMALS | EFFECT_AREA_LIGHTS);
    EXPECT_EQ(scene.effects.requests()[0].asked_by, "test.pbrt:11:1 (Shape \"trianglemesh\")");
}

TEST(BuildScene, OrientationFollowsReverseAndHandedness) {
    const BuiltText text =
        build_world(std::string("AttributeBegin\nScale -1 1 1\n") + kTriangle +
                    "AttributeEnd\nAttributeBegin\nReverseOrientation\n" + kTriangle +
                    "AttributeEnd\nAttributeBegin\nReverseOrientation\nScale 1 1 -1\nShape \"sphere\"\nAttributeEnd\n");
    ASSERT_EQ(text.all_errors(), "");
    const auto& geometries = text.scene().geometries;
    EXPECT_EQ(geometries[0].flags, GEOMETRY_FLIP);
    EXPECT_EQ(geometries[1].flags, GEOMETRY_FLIP | GEOMETRY_REVERSED);
    EXPECT_EQ(geometries[2].flags, GEOMETRY_REVERSED);
    EXPECT_EQ(text.scene().positions[3], -1.0f);
}

TEST(BuildScene, NormalsGoByTheInverseTransposeAndTheReversal) {
    const BuiltText text = build_world(
        "Scale 2 1 1\nReverseOrientation\nShape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"normal N\" [ 1 0 "
        "0 0 1 0 0 0 1 ]");
    ASSERT_EQ(text.all_errors(), "");
    EXPECT_EQ(text.scene().normals, (std::vector<float>{-0.5f, 0, 0, 0, -1, 0, 0, 0, -1}));
}

TEST(BuildScene, InfiniteLightsComeFirst) {
    const BuiltText text = build_world(
        std::string("LightSource \"point\" \"rgb I\" [ 1 2 3 ]\nAttributeBegin\nAreaLightSource \"diffuse\"\n") +
        kTriangle + "AttributeEnd\nLightSource \"infinite\" \"rgb L\" [ 0.5 0.5 0.5 ]\n");
    ASSERT_EQ(text.all_errors(), "");
    const Scene& scene = text.scene();
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.record.infinite_lights, 1u);
    EXPECT_EQ(scene.lights[0].kind, LIGHT_INFINITE);
    EXPECT_EQ(scene.lights[scene.geometries[0].first_light].kind, LIGHT_TRIANGLE);
    float sum = 0.0f;
    for (const LightRecord& light : scene.lights) sum += light.choice_probability;
    EXPECT_NEAR(sum, 1.0f, 1e-6f);
}

TEST(BuildScene, InstancesShareTheirSet) {
    const BuiltText text = build_world(std::string("ObjectBegin \"o\"\nTranslate 0 0 1\n") + kTriangle +
                                       "Shape \"sphere\"\nObjectEnd\n" + kTriangle +
                                       "ObjectBegin \"empty\"\nObjectEnd\nObjectInstance \"o\"\nAttributeBegin\nScale "
                                       "1 -2 1\nObjectInstance \"o\"\nAttributeEnd\nObjectInstance \"empty\"\n");
    ASSERT_EQ(text.all_errors(), "");
    const Scene& scene = text.scene();
    ASSERT_EQ(scene.instances.size(), 3u);
    for (const uint32_t i : {0u, 1u}) {
        EXPECT_EQ(scene.instances[i].first_geometry, i);
        EXPECT_EQ(scene.instances[i].geometry_count, i + 1);
        EXPECT_EQ(scene.instances[i].root_node, NONE);
        EXPECT_EQ(scene.instances[i].swaps_handedness, 0u);
    }
    EXPECT_EQ(scene.instances[2].swaps_handedness, 1u);
    EXPECT_EQ(scene.instance_sets, (std::vector<uint32_t>{0, 1, 1}));
    EXPECT_EQ(scene.instances[2].transform.to1, vec4(0.0f, -2.0f, 0.0f, 0.0f));
    EXPECT_EQ(scene.instances[2].transform.from1, vec4(0.0f, -0.5f, 0.0f, 0.0f));
    EXPECT_TRUE(scene.effects.has(EFFECT_INSTANCES));
    // Everything, quadrics and instances: x and y from -1 and -2 to 1 and 2, z from 0 to 2.
    EXPECT_NEAR(scene.record.bounds.w, std::sqrt(1.0f + 4.0f + 1.0f), 1e-5f);
}

TEST(BuildScene, ExposureAndCrop) {
    const BuiltText text = build_text(
        "Camera \"orthographic\" \"float shutterclose\" 0.5\nFilm \"rgb\" \"float iso\" 400 \"float "
        "maxcomponentvalue\" 10 "
        "\"integer xresolution\" 200 \"integer yresolution\" 100 \"float cropwindow\" [ 0.25 0.5 0 0.1 "
        "]\nWorldBegin\n");
    ASSERT_EQ(text.all_errors(), "");
    const CameraRecord& camera = text.scene().record.camera;
    EXPECT_FLOAT_EQ(camera.imaging_ratio, 2.0f);
    EXPECT_EQ(camera.max_component, 10.0f);
    EXPECT_EQ(text.built.settings.crop, (std::array<int, 4>{50, 0, 100, 10}));
    EXPECT_EQ(camera.screen.x, -2.0f);  // the shorter side is -1 to 1
    BuildOptions options;
    options.resolution = {{20, 10}};
    const BuiltText smaller = build_text(
        "Camera \"orthographic\"\nFilm \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100 \"float "
        "cropwindow\" [ 0.25 0.5 0 0.1 ]\nWorldBegin\n",
        false, options);
    EXPECT_EQ(smaller.built.settings.crop, (std::array<int, 4>{5, 0, 10, 1}));
    EXPECT_EQ(smaller.scene().width(), 20u);
}

// Both ends of a crop window are rounded up, as in pbrt-v4.
TEST(BuildScene, CropWindowsAreRoundedUp) {
    const BuiltText text = build_text(R"(
Camera "perspective"
Film "rgb" "integer xresolution" 10 "integer yresolution" 6 "float cropwindow" [ 0.25 0.75 0.5 0.875 ]
WorldBegin
)");
    ASSERT_EQ(text.all_errors(), "");
    EXPECT_EQ(text.built.settings.crop, (std::array<int, 4>{3, 3, 8, 6}));  // of 2.5, 3, 7.5 and 5.25
}

TEST(BuildScene, LightUnitsArePbrts) {
    const BuiltText text = build_world(R"(
AttributeBegin
LightSource "point" "blackbody I" 5000 "float scale" 3
LightSource "point" "rgb I" [ 2 2 2 ] "float power" 12.566370614
LightSource "spot" "float coneangle" 60 "float conedeltaangle" 0 "float power" 1
LightSource "distant" "float illuminance" 7 "rgb L" [ 1 1 1 ] "point3 from" [ 0 0 2 ] "point3 to" [ 0 0 1 ]
LightSource "infinite" "float illuminance" 3.14159265
AttributeEnd
)");
    ASSERT_EQ(text.all_errors(), "");
    const auto& lights = text.scene().lights;
    const auto luminance = [](Spectrum e) { return 0.2126f * e[0] + 0.7152f * e[1] + 0.0722f * e[2]; };
    EXPECT_NEAR(luminance(lights[0].emission), 1.0f,
                1e-5f);  // infinite: pi lux from a whole hemisphere is a radiance of 1
    EXPECT_NEAR(luminance(lights[1].emission), 7.0f, 1e-4f);  // distant lights come next
    EXPECT_EQ(lights[1].p0, glm::vec3(0.0f, 0.0f, 1.0f));
    EXPECT_NEAR(luminance(lights[2].emission), 3.0f, 3e-3f);  // a spectrum has luminance one
    EXPECT_GT(lights[2].emission[0], lights[2].emission[2]);  // and 5000 K is warmer than D65
    EXPECT_NEAR(luminance(lights[3].emission), 2.0f, 1e-4f);  // 4 pi lumens from an rgb of 2: as pbrt-v4, twice that
    EXPECT_NEAR(luminance(lights[4].emission), 1.0f / std::numbers::pi_v<float>, 1e-5f);  // 2 pi (1 - cos 60) = pi
}

// The smooth step of a spot's cosine is 1/2 on average between its angles, so that the power is
// 2 pi ((1 - cos 30) + (cos 30 - cos 60) / 2).
TEST(BuildScene, PowerOfASpotCountsItsFalloff) {
    const BuiltText text = build_world(R"(
LightSource "spot" "float coneangle" 60 "float conedeltaangle" 30 "float power" 1 "rgb I" [ 1 1 1 ]
)");
    ASSERT_EQ(text.all_errors(), "");
    const double begin = std::sqrt(0.75), end = 0.5;
    const double sphere = 2.0 * std::numbers::pi * ((1.0 - begin) + (begin - end) / 2.0);
    EXPECT_NEAR(text.scene().lights[0].emission[0], 1.0 / sphere, 1e-5);
}

void write_grey(const std::string& file, int side, const auto& value) {
    Image image(side, side, {"R", "G", "B"});
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            for (int c = 0; c < 3; ++c) image.at(x, y, c) = value(x, y);
    write_image(file, image);
}

// 2 pi (1 - cos), where the cosine of a float has no digits.
TEST(BuildScene, PowerOfANarrowSpotIsThatOfItsCone) {
    for (const double degrees : {0.1, 0.01, 1e-3}) {
        const BuiltText text = build_world(fmt::format(
            "LightSource \"spot\" \"float coneangle\" {} \"float conedeltaangle\" 0 \"float power\" 1\n", degrees));
        ASSERT_EQ(text.all_errors(), "");
        const double sphere = 4 * std::numbers::pi * std::pow(std::sin(degrees * std::numbers::pi / 360), 2);
        EXPECT_NEAR(text.scene().lights[0].emission[0] * sphere, 1.0, 1e-5) << degrees;
    }
}

// A white picture, as wide as it is high, fills the solid angle 4 asin(sin^2(fov / 2)), however few pixels it has.
TEST(BuildScene, PowerOfAProjectionIsThatOfItsSolidAngle) {
    const test::TemporaryFolder folder;
    for (const int side : {1, 2, 7, 32}) {
        write_grey(folder / "white.pfm", side, [](int, int) { return 1.0f; });
        for (const double fov : {0.01, 90.0, 179.0}) {
            const BuiltText text = build_text(
                fmt::format(
                    "Camera \"perspective\"\nWorldBegin\nLightSource \"projection\" \"string filename\" \"white.pfm\" "
                    "\"float fov\" {} \"float power\" 6\n",
                    fov),
                false, {}, folder.string());
            ASSERT_EQ(text.all_errors(), "");
            const double sine = std::sin(fov * std::numbers::pi / 360);
            const double sphere = 4.0 * std::asin(sine * sine);
            EXPECT_NEAR(text.scene().lights[0].emission[0] * sphere / 6.0, 1.0, 1e-5) << side << " " << fov;
        }
    }
}

// A sky of 1 gives pi, however few texels it has.
TEST(BuildScene, IlluminanceOfAnEvenSkyIsPi) {
    const test::TemporaryFolder folder;
    for (const int side : {1, 2, 3, 4, 5, 16, 300}) {
        write_grey(folder / "even.pfm", side, [](int, int) { return 1.0f; });
        const BuiltText text = build_text(
            "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\" \"string filename\" \"even.pfm\" \"float "
            "illuminance\" "
            "3.14159265\n",
            false, {}, folder.string());
        ASSERT_EQ(text.all_errors(), "");
        EXPECT_NEAR(text.scene().lights[0].emission[0], 1.0, 1e-5) << side;
    }
}

// A sky that is 2 where s and t are between 1/4 and 1/2 on the octahedral square, else 0. With u = 1 - 2 s and
// v = 1 - 2 t, z is 1 - (u + v)^2 there, on average 17/24, over the solid angle 4 pi / 16.
TEST(BuildScene, IlluminanceOfASkyIsThatOfItsImage) {
    const test::TemporaryFolder folder;
    write_grey(folder / "sky.pfm", 16, [](int x, int y) { return x >= 4 && x < 8 && y >= 4 && y < 8 ? 2.0f : 0.0f; });
    const char* scene = R"(
Camera "perspective"
WorldBegin
LightSource "infinite" "string filename" "sky.pfm" "float illuminance" 5
)";
    const BuiltText text = build_text(scene, false, {}, folder.string());
    ASSERT_EQ(text.all_errors(), "");
    const double of_image = 2.0 * 17.0 / 24.0 * 4.0 * std::numbers::pi / 16.0;
    EXPECT_NEAR(text.scene().lights[0].emission[0], 5.0 / of_image, 1e-4 * 5.0 / of_image);
}

TEST(BuildScene, MaterialsAndTheirEffects) {
    const BuiltText text = build_world(std::string(R"(
MakeNamedMaterial "unused" "string type" "dielectric"
MakeNamedMaterial "gold" "string type" "conductor" "spectrum eta" "metal-Au-eta" "spectrum k" "metal-Au-k" "float uroughness" 0.1
MakeNamedMaterial "plastic" "string type" "coateddiffuse" "float roughness" 0.3 "bool remaproughness" false
MakeNamedMaterial "both" "string type" "mix" "string materials" [ "gold" "plastic" ] "float amount" 0.25
NamedMaterial "both"
)") + kTriangle);
    ASSERT_EQ(text.all_errors(), "");
    const auto& materials = text.scene().materials;
    ASSERT_EQ(materials.size(), 3u);
    const MaterialRecord& mix = materials[text.scene().geometries[0].material];
    EXPECT_EQ(mix.kind, MATERIAL_MIX);
    EXPECT_EQ(mix.amount, 0.25f);
    const MaterialRecord& gold = materials[mix.first_material];
    EXPECT_EQ(gold.kind, MATERIAL_CONDUCTOR);
    EXPECT_EQ(gold.flags, MATERIAL_REMAP);
    EXPECT_EQ(gold.roughness_u, 0.1f);
    EXPECT_EQ(gold.roughness_v, 0.0f);
    // Gold reflects red far better than blue.
    const auto reflectance = [&](int c) {
        const float n = gold.color0[c], k = gold.color1[c];
        return ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
    };
    EXPECT_GT(reflectance(0), 0.95f);
    EXPECT_NEAR(reflectance(1), 0.78f, 0.02f);
    EXPECT_NEAR(reflectance(2), 0.34f, 0.02f);
    const MaterialRecord& plastic = materials[mix.second_material];
    EXPECT_EQ(plastic.flags, 0u);
    EXPECT_EQ(plastic.roughness_u, 0.3f);
    EXPECT_EQ(plastic.roughness_v, 0.3f);
    EXPECT_EQ(plastic.eta, 1.5f);
    EXPECT_EQ(plastic.g, 0.0f);
    EXPECT_EQ(plastic.thickness, 0.01f);
    EXPECT_EQ(plastic.max_depth, 10u);
    EXPECT_EQ(text.scene().effects.mask(), EFFECT_MATERIAL_MIX | EFFECT_CONDUCTOR | EFFECT_ROUGH | EFFECT_ANISOTROPIC |
                                               EFFECT_LAYERED_COAT | EFFECT_DIELECTRIC);
}

// Photons are stored according to it (visible_point.h): it is no less than the roughness anywhere on the material.
TEST(BuildScene, MaterialsSayHowRoughTheyGet) {
    const BuiltText text = build_world(std::string(R"(
Texture "spots" "float" "checkerboard" "float tex1" 0 "float tex2" 0.01
MakeNamedMaterial "matte" "string type" "diffuse"
MakeNamedMaterial "mirror" "string type" "conductor"
MakeNamedMaterial "pane" "string type" "thindielectric"
MakeNamedMaterial "satin" "string type" "conductor" "float uroughness" 0.04 "float vroughness" 0.09
MakeNamedMaterial "frosted" "string type" "dielectric" "float roughness" 0.2 "bool remaproughness" false
MakeNamedMaterial "spotted" "string type" "conductor" "texture roughness" "spots"
MakeNamedMaterial "varnished" "string type" "coatedconductor" "float conductor.roughness" 0.04 "float interface.roughness" 0.01
MakeNamedMaterial "plastic" "string type" "coateddiffuse"
MakeNamedMaterial "none" "string type" "mix" "string materials" [ "mirror" "matte" ] "float amount" 0
MakeNamedMaterial "all" "string type" "mix" "string materials" [ "matte" "pane" ] "float amount" 1
MakeNamedMaterial "some" "string type" "mix" "string materials" [ "satin" "mirror" ] "float amount" 0.99
MakeNamedMaterial "nested" "string type" "mix" "string materials" [ "none" "some" ] "texture amount" "spots"
MakeNamedMaterial "deep" "string type" "mix" "string materials" [ "nested" "matte" ]
)") + [] {
        std::string shapes;
        for (const char* name : {"matte", "mirror", "pane", "satin", "frosted", "spotted", "varnished", "plastic",
                                 "none", "all", "some", "nested", "deep"})
            shapes += "NamedMaterial \"" + std::string(name) + "\"\n" + kTriangle;
        return shapes;
    }());
    ASSERT_EQ(text.all_errors(), "");
    const float diffuse = 1e30f;
    const std::vector<float> expected{diffuse, 0.0f, 0.0f, 0.3f, 0.2f, diffuse, 0.2f,
                                      diffuse, 0.0f, 0.0f, 0.3f, 0.3f, diffuse};
    ASSERT_EQ(text.scene().geometries.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i)
        EXPECT_FLOAT_EQ(text.scene().materials[text.scene().geometries[i].material].roughest_alpha, expected[i]) << i;
}

TEST(BuildScene, MediaThatAbsorb) {
    const BuiltText text = build_text(R"(
MakeNamedMedium "air" "string type" "homogeneous" "rgb sigma_a" [ 0 0 0 ] "rgb sigma_s" [ 0 0 0 ]
MediumInterface "" "sea"
Camera "perspective"
WorldBegin
MakeNamedMedium "sea" "string type" "homogeneous" "rgb sigma_a" [ 1 2 3 ] "rgb sigma_s" [ 0 0 0 ] "float scale" 2
MakeNamedMedium "ink" "string type" "homogeneous" "rgb sigma_s" [ 0 0 0 ]
MediumInterface "air" "sea"
LightSource "point"
LightSource "infinite"
Shape "sphere"
MediumInterface "ink"
Shape "sphere"
MediumInterface "" ""
Shape "sphere"
)");
    ASSERT_EQ(text.all_errors(), "");
    const Scene& scene = text.scene();
    // Empty space, then media in the order of their use; a medium that does not absorb is empty space.
    ASSERT_EQ(scene.media.size(), 3u);
    EXPECT_EQ(scene.media[MEDIUM_VACUUM].sigma_a, Spectrum(0.0f));
    EXPECT_EQ(scene.media[1].sigma_a, Spectrum(2.0f, 4.0f, 6.0f));
    EXPECT_EQ(scene.media[2].sigma_a, Spectrum(1.0f));
    EXPECT_EQ(scene.record.camera_medium, 1u);
    EXPECT_EQ(scene.geometries[0].media, MEDIUM_VACUUM << 16 | 1u);
    EXPECT_EQ(scene.geometries[1].media, 2u << 16 | 2u);
    EXPECT_EQ(scene.geometries[2].media, MEDIUM_VACUUM);
    ASSERT_EQ(scene.lights.size(), 2u);
    for (const LightRecord& light : scene.lights) EXPECT_EQ(light.flags >> 16, 1u);
    ASSERT_TRUE(scene.effects.has(EFFECT_MEDIUM));
    for (const EffectRequest& request : scene.effects.requests()) {
        if (request.effect != EFFECT_MEDIUM) continue;
        EXPECT_EQ(request.asked_by, "test.pbrt:6:1 (MakeNamedMedium \"homogeneous\")");
    }
    // A medium that contains nothing needs no effect.
    const BuiltText unused =
        build_world("MakeNamedMedium \"ink\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [ 0 0 0 ]\n");
    EXPECT_EQ(unused.all_errors(), "");
    EXPECT_FALSE(unused.scene().effects.has(EFFECT_MEDIUM));
    EXPECT_TRUE(unused.scene().media.empty());
}

}  // namespace
}  // namespace lampyris

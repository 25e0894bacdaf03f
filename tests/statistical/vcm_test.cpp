// Vertex connection and merging, and bidirectional photon mapping: against the methods that they unite, with every photon map, and
// against themselves.
//
// False alarms: kAlpha (1e-6) for each image that is compared, at fixed seeds.
#include "support/blocks.h"
#include "support/same_image.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace lampyris::test {
namespace {

class Merging : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, Merging, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

class MergingScenes : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Scenes, MergingScenes, testing::ValuesIn(varied_scenes()),
                         [](const auto& info) { return test_name(info.param); });
INSTANTIATE_TEST_SUITE_P(LongScenes, MergingScenes, testing::ValuesIn(further_scenes()),
                         [](const auto& info) { return test_name(info.param); });

// The radius is so small that merging contributes little, and its bias is less. 1e-3: in scenes without noise, merged photons are
// so few that a block may have none.
TEST_P(MergingScenes, AgreeWithPathTracing) {
    const std::string scene = GetParam();
    if (scene == "reference/sds-point" || scene == "reference/sds-pool") return;  // path never finds their light
    RenderSettings settings = settings_of("cpu", "path:maxdepth=8", 256, 24);
    const Rendered path = render_file(scene_path(scene), settings);
    settings.seed = 5;
    settings.samples = 64;
    for (const char* options : {"share=0.001", "share=0.001,weights=power,connections=1"}) {
        settings.integrator = fmt::format("vcm:maxdepth=8,{}", options);
        expect_same_blocks(render_file(scene_path(scene), settings), path, 12, fmt::format("vcm {} {}", scene, options),
                           1e-3);
    }
}

// Light of a point that is seen through glass only merging finds. Eye paths and photons of sppm have a maxdepth each, so both
// are without one here. 4 %: both have a bias, sppm by its radius in corners, both at the edges of caustics.
TEST(Merging, FindsWhatNoConnectionDoes) {
    for (const char* scene : {"reference/sds-point", "reference/sds-pool"}) {
        RenderSettings settings = settings_of("cpu", "sppm:maxdepth=40,radius=0.03", 64, 32);
        const Rendered sppm = render_file(scene_path(scene), settings);
        for (const char* integrator : {"vcm:maxdepth=40,radius=0.03", "bpm:maxdepth=40,radius=0.03"}) {
            settings.integrator = integrator;
            const Rendered image = render_file(scene_path(scene), settings);
            const Block a = whole(image), b = whole(sppm);
            EXPECT_LT(std::abs(a.mean - b.mean), 0.04 * b.mean) << scene << " " << integrator;
            EXPECT_LT(std::hypot(a.error(), b.error()), 0.015 * b.mean) << scene << ": the test has no power";
        }
    }
}

// A unit sphere of albedo 1/2 around a point light of intensity pi: paths with k scattering vertices show 1/2^k. Merging alone
// finds all of up to maxdepth vertices. A ball about a point of the sphere cuts out a cap of area pi r^2 exactly.
TEST(Merging, FindsPathsOfEveryLength) {
    for (const int depth : {1, 3}) {
        SCOPED_TRACE(depth);
        const std::string integrator = fmt::format("bpm:maxdepth={},radius=0.05,lightpaths=20000", depth);
        const Mean mean = mean_of_runs("analytic/sphere-point.pbrt", settings_of("cpu", integrator, 4, 16), 8);
        expect_mean(mean, 1.0 - std::ldexp(1.0, -depth), 1e-4);
        EXPECT_LT(mean.error(), 0.01);
    }
}

// In a closed box all methods show the same; bpm's disks reach beyond corners, where it shows less (the share of the walls within
// a radius of an edge is 3 r / 2, and a disk there is half outside at most).
TEST_P(Merging, EveryPhotonMapAgrees) {
    for (const char* integrator : {"vcm:maxdepth=6,radius=0.05", "bpm:maxdepth=6,radius=0.05"}) {
        RenderSettings settings = settings_of(GetParam(), integrator, 64, 16);
        settings.seed = 2;
        const Block right = whole(render_file(scene_path("analytic/box-half"), settings));
        settings.seed = 1;
        for (const char* map : {"sorted_grid", "uniform_grid", "linked_list", "hash_list", "cuckoo", "kd_tree", "bvh",
                                "stochastic_hash", "brute_force", "splat"}) {
            if (GetParam() == "vulkan" && map != std::string("sorted_grid") && map != std::string("stochastic_hash"))
                continue;
            settings.photon_map = map;
            const Block found = whole(render_file(scene_path("analytic/box-half"), settings));
            EXPECT_LT(std::abs(found.mean - right.mean),
                      normal_threshold(kAlpha) * std::hypot(found.error(), right.error()))
                << map << " " << integrator << ": " << found.mean << " +- " << found.error() << ", " << right.mean
                << " +- " << right.error();
            EXPECT_LT(found.error(), 0.02 * right.mean) << map << ": the test has no power";
        }
    }
}

// Photon and camera path both choose at masks and in mixes; a merged vertex is one vertex.
TEST_P(Merging, MasksAndMixesAreChosenOnce) {
    for (const char* floor : {R"(Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "point3 P" [ -4 0 -4  4 0 -4  4 0 4  -4 0 4 ] "integer indices" [ 0 2 1 0 3 2 ] "float alpha" 0.5)",
                              R"(MakeNamedMaterial "a" "string type" "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
MakeNamedMaterial "b" "string type" "conductor" "float roughness" 0
Material "mix" "string materials" [ "a" "b" ] "float amount" 0.5
Shape "trianglemesh" "point3 P" [ -4 0 -4  4 0 -4  4 0 4  -4 0 4 ] "integer indices" [ 0 2 1 0 3 2 ])"}) {
        const std::string text = fmt::format(R"(
LookAt 0 2 -2  0 0 0  0 1 0
Camera "perspective" "float fov" 30
PixelFilter "box"
Film "rgb" "integer xresolution" 12 "integer yresolution" 12
WorldBegin
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 5 5 5 ]
  Translate 0 3 0
  Shape "sphere" "float radius" 0.3
AttributeEnd
{}
)",
                                             floor);
        RenderSettings settings = settings_of("cpu", "path:maxdepth=3", 512, 0);
        const Block path = whole(render_text(text, settings));
        settings.backend = GetParam();
        settings.samples = 512;
        for (const char* integrator : {"vcm:maxdepth=3,radius=0.1,lightpaths=3000",
                                       "bpm:maxdepth=3,radius=0.1,lightpaths=3000", "bdpt:maxdepth=3"}) {
            settings.integrator = integrator;
            const Block found = whole(render_text(text, settings));
            EXPECT_LT(std::abs(found.mean - path.mean),
                      normal_threshold(kAlpha) * std::hypot(found.error(), path.error()))
                << integrator << ": " << found.mean << " +- " << found.error() << ", path " << path.mean << " +- "
                << path.error();
            EXPECT_LT(found.error(), 0.02 * path.mean) << integrator << ": the test has no power";
        }
    }
}

// One path that differs by a rounding may reach several pixels, by splats and as photons.
TEST(Merging, SameOnEveryBackendAndThread) {
    for (const char* integrator : {"vcm:maxdepth=5,radius=0.05", "bpm:maxdepth=5,radius=0.05"})
        expect_same_on_every_backend("reference/diffuse", settings_of("cpu", integrator, 3, 32), 0.99);
}

// Merging vanishes with the radius: what is left is bdpt, and not a quotient of zeros.
TEST_P(Merging, TinyRadiiLeaveBdpt) {
    RenderSettings settings = settings_of(GetParam(), "bdpt:maxdepth=5", 4, 16);
    const Rendered bdpt = render_file(scene_path("reference/diffuse"), settings);
    settings.integrator = "vcm:maxdepth=5,radius=1e-25";
    const Rendered vcm = render_file(scene_path("reference/diffuse"), settings);
    for (size_t i = 0; i < vcm.pixels.size(); ++i) {
        EXPECT_EQ(vcm.pixels[i].left_out, 0u);
        EXPECT_NEAR(vcm.pixels[i].sum.x, bdpt.pixels[i].sum.x, 1e-4f * bdpt.pixels[i].sum.x);
    }
}

TEST(Merging, MapsThatDropPhotonsAreRefused) {
    RenderSettings settings = settings_of("cpu", "vcm", 1, 8);
    settings.photon_map = "uniform_grid:capacity=4,overflow=drop";
    EXPECT_THROW(render_file(scene_path("reference/diffuse"), settings), InputError);
}

}  // namespace
}  // namespace lampyris::test

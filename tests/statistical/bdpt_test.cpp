// Bidirectional path tracing: against path tracing, closed forms of each strategy, and itself with other threads, crops and
// backends.
//
// False alarms: kAlpha (1e-6) for each image that is compared, at fixed seeds. Power: a factor wrong by 3 % in the image is more than
// eight standard errors of its mean.
#include "support/blocks.h"
#include "support/same_image.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace lampyris::test {
namespace {

class Bidirectional : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, Bidirectional, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

// ---- Against path tracing --------------------------------------------------------------------------------------------

using SceneOnBackend = std::tuple<std::string, std::string>;
class BidirectionalScenes : public testing::TestWithParam<SceneOnBackend> {};
std::string name_of_scene(const testing::TestParamInfo<SceneOnBackend>& info) {
    return test_name(std::get<0>(info.param) + "_" + std::get<1>(info.param));
}
const auto kTracers = testing::Values("cpu", "cpu-bvh2");
INSTANTIATE_TEST_SUITE_P(Scenes, BidirectionalScenes, testing::Combine(testing::ValuesIn(varied_scenes()), kTracers),
                         name_of_scene);
INSTANTIATE_TEST_SUITE_P(LongScenes, BidirectionalScenes,
                         testing::Combine(testing::ValuesIn(further_scenes()), kTracers), name_of_scene);

// Path tracing never finds a point light through glass or in a mirror: bdpt finds it on the surfaces that are seen directly.
bool path_is_blind(const std::string& scene) { return scene == "reference/sds-point" || scene == "reference/sds-pool"; }

TEST_P(BidirectionalScenes, AgreeWithPathTracing) {
    const auto& [scene, backend] = GetParam();
    if (path_is_blind(scene)) return;
    RenderSettings settings = settings_of("cpu", "path:maxdepth=8", 256, 24);
    const Rendered path = render_file(scene_path(scene), settings);
    settings.backend = backend;
    settings.samples = 64;
    settings.seed = 5;
    for (const char* weights : {"balance", "power"}) {
        settings.integrator = fmt::format("bdpt:maxdepth=8,weights={}", weights);
        const Rendered image = render_file(scene_path(scene), settings);
        expect_same_blocks(image, path, 12, fmt::format("bdpt {} {} {}", scene, backend, weights));
    }
}

// ---- Closed forms ----------------------------------------------------------------------------------------------------

// The inside of a sphere that emits 1 and reflects `albedo`: paths with k scattering vertices show albedo^k everywhere, by
// any strategy alone.
std::string sphere(double albedo) {
    return fmt::format(R"(
LookAt 0.2 -0.1 -0.3  0 0.1 1  0 1 0
Camera "perspective" "float fov" 70
Sampler "independent"
PixelFilter "box"
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
WorldBegin
AreaLightSource "diffuse" "rgb L" [ 1 1 1 ] "bool twosided" true
Material "diffuse" "rgb reflectance" [ {0} {0} {0} ]
Shape "sphere" "float radius" 2
)",
                       albedo);
}

TEST_P(Bidirectional, EachStrategyAloneShowsItsPaths) {
    const double albedo = 0.6;
    const std::string text = sphere(albedo);
    for (int k = 1; k <= 4; ++k)
        for (int s = 0; s <= k + 1; ++s) {
            const int t = k + 2 - s;
            if (GetParam() == "vulkan" && k != 3) continue;  // the same kernels
            const std::string integrator = fmt::format("bdpt:maxdepth=6,weights=none,s={},t={},rrdepth=100", s, t);
            const Rendered image = render_text(text, settings_of(GetParam(), integrator, 768, 0));
            const Block all = whole(image);
            EXPECT_LT(std::abs(all.mean - std::pow(albedo, k)), normal_threshold(kAlpha) * all.error() + 1e-5)
                << "s = " << s << ", t = " << t << ": " << all.mean << " +- " << all.error() << ", right "
                << std::pow(albedo, k);
            EXPECT_LT(all.error(), 0.05 * std::pow(albedo, k)) << "the test has no power";
        }
}

// The same for connections to many light paths, which pixels share: errors are those between runs.
TEST_P(Bidirectional, EachStrategyOfTheCacheShowsItsPaths) {
    constexpr double kAlbedo = 0.6;
    constexpr uint32_t kRuns = 16;
    for (const auto& [s, t] : {std::pair(2, 2), std::pair(2, 3), std::pair(3, 2), std::pair(4, 2)}) {
        if (GetParam() == "vulkan" && s != 3) continue;  // the same kernels
        const double right = std::pow(kAlbedo, s + t - 2);
        const std::string integrator = fmt::format("bdpt:maxdepth=6,cache=2,weights=none,s={},t={},rrdepth=100", s, t);
        const Mean mean = mean_of_text_runs(sphere(kAlbedo), settings_of(GetParam(), integrator, 64, 0), kRuns);
        EXPECT_LT(std::abs(mean.value() - right), student_threshold(kAlpha, kRuns - 1) * mean.error() + 1e-5)
            << "s = " << s << ", t = " << t << ": " << mean.value() << " +- " << mean.error() << ", right " << right;
        EXPECT_LT(mean.error(), 0.01 * right) << "the test has no power";
    }
}

// The weighted strategies are the parts of the whole: the same random numbers, up to the rounding of sums.
TEST_P(Bidirectional, StrategiesAddUpToTheWhole) {
    const std::string text = sphere(0.5);
    const int depth = 3;
    const auto image_of = [&](const std::string& more) {
        RenderSettings settings = settings_of(GetParam(), fmt::format("bdpt:maxdepth={}{}", depth, more), 4, 0);
        return render_text(text, settings);
    };
    const Rendered all = image_of("");
    std::vector<double> sum(all.pixels.size());
    for (int k = 0; k <= depth; ++k)
        for (int s = 0; s <= k + 1; ++s) {
            const Rendered part = image_of(fmt::format(",s={},t={}", s, k + 2 - s));
            for (size_t i = 0; i < sum.size(); ++i) sum[i] += double(part.pixels[i].sum.x);
        }
    for (size_t i = 0; i < sum.size(); ++i) EXPECT_NEAR(sum[i], double(all.pixels[i].sum.x), 1e-4 * sum[i]);
    // The same images as layers of one.
    const Rendered layered = image_of(",strategies=on");
    double total = 0, layers = 0;
    for (size_t c = 0; c < layered.image.channel_names.size(); ++c) {
        const std::string& name = layered.image.channel_names[c];
        for (size_t i = c; i < layered.image.pixels.size(); i += size_t(layered.image.channels)) {
            if (name == "G") total += double(layered.image.pixels[i]);
            if (name.starts_with("strategy.") && name.ends_with(".G")) layers += double(layered.image.pixels[i]);
        }
    }
    EXPECT_NEAR(layers, total, 1e-4 * total);
    EXPECT_GT(total, 0.0);
}

// Fewer connections, fewer or more light paths, and either heuristic change the noise alone. Pixels share light paths if there are
// few, so errors are those between runs.
TEST_P(Bidirectional, ChoicesChangeNoMean) {
    const std::string text = sphere(0.7);
    double right = 0;
    for (int k = 0; k <= 6; ++k) right += std::pow(0.7, k);
    constexpr uint32_t kRuns = 16;
    for (const char* choice : {"connections=0", "connections=1", "connections=2", "lightpaths=7", "lightpaths=1000",
                               "weights=power", "connections=0,weights=power", "rrdepth=0", "cache=1", "cache=3",
                               "cache=2,weights=power", "cache=2,lightpaths=7"}) {
        const std::string integrator = fmt::format("bdpt:maxdepth=6,{}", choice);
        const Mean mean = mean_of_text_runs(text, settings_of(GetParam(), integrator, 16, 0), kRuns);
        EXPECT_LT(std::abs(mean.value() - right), student_threshold(kAlpha, kRuns - 1) * mean.error() + 1e-4)
            << choice << ": " << mean.value() << " +- " << mean.error();
        EXPECT_LT(mean.error(), 0.01 * right) << choice << ": the test has no power";
    }
}

// A point light within glass, seen through glass or in a mirror: no strategy finds paths with so few vertices, so these pixels are
// exactly black. Merging finds them, and what is seen directly is there.
TEST_P(Bidirectional, SpecularDiffuseSpecularPathsAreBlack) {
    RenderSettings settings = settings_of(GetParam(), "bdpt:maxdepth=3", 16, 24);
    const Rendered bdpt = render_file(scene_path("reference/sds-point"), settings);
    constexpr std::array<int, 2> kThroughGlass{8, 18}, kInMirror{16, 16}, kFloor{12, 22};
    EXPECT_EQ(bdpt.luminance(kThroughGlass[0], kThroughGlass[1]), 0.0);
    EXPECT_EQ(bdpt.luminance(kInMirror[0], kInMirror[1]), 0.0);
    EXPECT_GT(bdpt.luminance(kFloor[0], kFloor[1]), 0.0);
    if (GetParam() == "vulkan") return;  // the same kernels
    settings.integrator = "vcm:maxdepth=4,radius=0.1";
    const Rendered vcm = render_file(scene_path("reference/sds-point"), settings);
    EXPECT_GT(vcm.luminance(kThroughGlass[0], kThroughGlass[1]), 0.0);
    EXPECT_GT(vcm.luminance(kInMirror[0], kInMirror[1]), 0.0);
}

// Shading normals that are not those of the surface: a ball of few triangles with vertex normals, and a bump map, in the light of a
// point. Scattering is then not symmetric, and light paths need the adjoint factor. The strategy t = 1 alone shows what path tracing
// shows, if path tracing is let do only what t = 1 can (one and two scattering vertices).
TEST_P(Bidirectional, ShadingNormalsAreTheSameFromBothSides) {
    const std::string world = R"(
LookAt 0 1.5 -4  0 0.4 0  0 1 0
Camera "perspective" "float fov" 35
PixelFilter "box"
Film "rgb" "integer xresolution" 24 "integer yresolution" 24
WorldBegin
LightSource "point" "point3 from" [ 1.5 3 -1.5 ] "rgb I" [ 10 10 10 ]
Texture "waves" "float" "checkerboard" "float uscale" 6 "float vscale" 6 "float tex1" 0.02 "float tex2" 0
Material "diffuse" "rgb reflectance" [ 0.7 0.7 0.7 ] "texture displacement" "waves"
Shape "trianglemesh" "point3 P" [ -3 -0.7 -3  3 -0.7 -3  3 -0.7 3  -3 -0.7 3 ] "point2 uv" [ 0 0 1 0 1 1 0 1 ]
  "integer indices" [ 0 2 1 0 3 2 ]
Material "diffuse" "rgb reflectance" [ 0.6 0.6 0.6 ]
Shape "trianglemesh" "point3 P" [ 1 0 0  -1 0 0  0 1 0  0 -1 0  0 0 1  0 0 -1 ] "normal N" [ 1 0 0  -1 0 0  0 1 0  0 -1 0  0 0 1  0 0 -1 ]
  "integer indices" [ 0 2 4  2 1 4  1 3 4  3 0 4  2 0 5  1 2 5  3 1 5  0 3 5 ]
)";
    for (const int k : {1, 2}) {
        RenderSettings settings = settings_of("cpu", fmt::format("path:maxdepth={}", k), 256, 0);
        const Rendered path = render_text(world, settings);
        settings.integrator = fmt::format("path:maxdepth={}", k - 1);
        const Rendered before = render_text(world, settings);
        // The image of paths with exactly k vertices: both have the same random numbers up to there.
        settings.backend = GetParam();
        settings.integrator = fmt::format("bdpt:maxdepth={},weights=none,s={},t=1", k, k + 1);
        const Rendered light = render_text(world, settings);
        const auto compare = [&](int x0, int y0, int x1, int y1) {
            const Block a = block(light, x0, y0, x1, y1), b = block(path, x0, y0, x1, y1),
                        c = block(before, x0, y0, x1, y1);
            const double error = std::sqrt(a.variance + b.variance + c.variance) + 1e-6;
            EXPECT_LT(std::abs(a.mean - (b.mean - c.mean)), normal_threshold(kAlpha / 5) * error)
                << "k = " << k << ", from " << x0 << " " << y0 << ": " << a.mean << ", path " << b.mean - c.mean
                << " +- " << error;
        };
        for (const int x : {0, 12})
            for (const int y : {0, 12}) compare(x, y, x + 12, y + 12);
        compare(0, 0, 24, 24);
    }
}

// The same flux arrives if a diffuse lamp and what an orthographic pixel sees change places, with glass that absorbs between
// them: both are patches of the same area, so the pictures' means are equal.
TEST_P(Bidirectional, LampAndSensorMayChangePlaces) {
    const auto text = [](bool swapped) {
        const char* low = "-0.5 0 -0.5  0.5 0 -0.5  0.5 0 0.5  -0.5 0 0.5";
        const char* high = "1 2 -0.5  2 2 -0.5  2 2 0.5  1 2 0.5";
        return fmt::format(R"(
LookAt {}
Camera "orthographic" "float screenwindow" [ -0.5 0.5 -0.5 0.5 ]
PixelFilter "box"
Film "rgb" "integer xresolution" 4 "integer yresolution" 4
WorldBegin
MakeNamedMedium "ink" "string type" "homogeneous" "rgb sigma_a" [ 0.8 0.8 0.8 ] "rgb sigma_s" [ 0 0 0 ]
AttributeBegin
  MediumInterface "ink" ""
  Material "dielectric" "float eta" 1.5 "float roughness" 0.3
  Translate 0.75 1 0
  Shape "sphere" "float radius" 0.4
AttributeEnd
AttributeBegin
  Material "diffuse" "rgb reflectance" [ 0 0 0 ]
  AreaLightSource "diffuse" "rgb L" [ 10 10 10 ]
  Shape "trianglemesh" "point3 P" [ {} ] "integer indices" [ {} ]
AttributeEnd
Material "diffuse" "rgb reflectance" [ 1 1 1 ]
Shape "trianglemesh" "point3 P" [ {} ] "integer indices" [ 0 2 1 0 3 2 ]
)",
                           swapped ? "1.5 1.9 0  1.5 2 0  0 0 1" : "0 0.1 0  0 0 0  0 0 1", swapped ? low : high,
                           swapped ? "0 2 1 0 3 2" : "0 1 2 0 2 3", swapped ? high : low);
    };
    std::array<Mean, 2> means;
    for (const bool swapped : {false, true})
        means[swapped] = mean_of_text_runs(text(swapped), settings_of(GetParam(), "bdpt:maxdepth=6", 1024, 0), 12);
    const double error = std::hypot(means[0].error(), means[1].error());
    EXPECT_LT(std::abs(means[0].value() - means[1].value()), student_threshold(kAlpha, 11) * error)
        << means[0].value() << " +- " << means[0].error() << ", " << means[1].value() << " +- " << means[1].error();
    EXPECT_LT(error, 0.01 * means[0].value()) << "the test has no power";
}

TEST(Bidirectional, UnweightedStrategiesAreShownOneByOne) {
    EXPECT_THROW(render_text(sphere(0.5), settings_of("cpu", "bdpt:weights=none", 1, 0)), InputError);
    EXPECT_THROW(render_text(sphere(0.5), settings_of("cpu", "bdpt:strategies=on,maxdepth=100", 1, 0)), InputError);
}

TEST(Bidirectional, TheCacheChoosesVerticesItself) {
    EXPECT_THROW(render_text(sphere(0.5), settings_of("cpu", "bdpt:cache=1,connections=2", 1, 0)), InputError);
    EXPECT_THROW(render_text(sphere(0.5), settings_of("cpu", "vcm:cache=1,connections=0", 1, 0)), InputError);
}

// ---- The same image --------------------------------------------------------------------------------------------------

// One path that differs by a rounding may reach several pixels: the share of docs/determinism.md, twice.
TEST(Bidirectional, SameOnEveryBackendAndThread) {
    const RenderSettings settings = settings_of("cpu", "bdpt:maxdepth=5", 3, 32);
    expect_same_on_every_backend("reference/dielectric-rough", settings, 0.996);
    for (const char* name : {"reference/diffuse", "analytic/box-half"}) expect_same_on_the_cpu(name, settings, 0.996);
    expect_same_on_every_backend("reference/diffuse", settings_of("cpu", "bdpt:maxdepth=5,cache=2", 3, 32), 0.996);
}

TEST_P(Bidirectional, CropsArePartsOfTheWhole) {
    expect_crop_is_part_of_the_whole("reference/diffuse", settings_of(GetParam(), "bdpt", 2, 0));
    expect_crop_is_part_of_the_whole("reference/diffuse", settings_of(GetParam(), "bdpt:cache=1", 2, 0));
}

}  // namespace
}  // namespace lampyris::test

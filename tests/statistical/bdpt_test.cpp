// Bidirectional path tracing: against path tracing, closed forms of each strategy, and itself with other threads, crops and
// backends.
//
// False alarms: kAlpha (1e-6) for each image that is compared, at fixed seeds. Power: a factor wrong by 3 % in the image is more than
// eight standard errors of its mean.
#include "support/agreement.h"
#include "support/blocks.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace lampyris::test {
namespace {

class Bidirectional : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, Bidirectional, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

// ---- Against path tracing --------------------------------------------------------------------------------------------

class BidirectionalScenes : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Scenes, BidirectionalScenes, testing::ValuesIn(small_scenes()),
                         [](const auto& info) { return test_name(info.param); });

// Path tracing never finds a point light through glass or in a mirror: bdpt finds it on the surfaces that are seen directly.
bool path_is_blind(const std::string& scene) { return scene == "reference/sds-point" || scene == "reference/sds-pool"; }

TEST_P(BidirectionalScenes, AgreeWithPathTracing) {
    if (path_is_blind(GetParam())) return;
    for (const char* backend : {"cpu", "cpu-bvh2"}) {
        RenderSettings settings = settings_of("cpu", "path:maxdepth=8", 256, 24);
        const Rendered path = render_file(scene_path(GetParam()), settings);
        settings.backend = backend;
        settings.samples = 64;
        settings.seed = 5;
        for (const char* weights : {"balance", "power"}) {
            settings.integrator = fmt::format("bdpt:maxdepth=8,weights={}", weights);
            const Rendered image = render_file(scene_path(GetParam()), settings);
            expect_same_blocks(image, path, 12, fmt::format("bdpt {} {} {}", GetParam(), backend, weights));
        }
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
}

// Fewer connections, fewer or more light paths, and either heuristic change the noise alone. Pixels share light paths if there are
// few, so errors are those between runs.
TEST_P(Bidirectional, ChoicesChangeNoMean) {
    const std::string text = sphere(0.7);
    double right = 0;
    for (int k = 0; k <= 6; ++k) right += std::pow(0.7, k);
    constexpr uint32_t kRuns = 16;
    for (const char* choice : {"connections=0", "connections=1", "connections=2", "lightpaths=7", "lightpaths=1000",
                               "weights=power", "connections=0,weights=power", "rrdepth=0"}) {
        const std::string integrator = fmt::format("bdpt:maxdepth=6,{}", choice);
        const Mean mean = mean_of_text_runs(text, settings_of(GetParam(), integrator, 16, 0), kRuns);
        EXPECT_LT(std::abs(mean.value() - right), student_threshold(kAlpha, kRuns - 1) * mean.error() + 1e-4)
            << choice << ": " << mean.value() << " +- " << mean.error();
        EXPECT_LT(mean.error(), 0.01 * right) << choice << ": the test has no power";
    }
}

// ---- The same image --------------------------------------------------------------------------------------------------

TEST(Bidirectional, SameOnEveryBackendAndThread) {
    for (const char* name : {"reference/diffuse", "reference/dielectric-rough", "analytic/box-half"}) {
        RenderSettings settings = settings_of("cpu", "bdpt:maxdepth=5", 3, 32);
        settings.threads = 1;
        const Rendered one = render_file(scene_path(name), settings);
        for (const std::string& backend : usable_backends())
            for (const unsigned threads : {1u, 2u, 7u}) {
                if (backend != "cpu" && threads > 1) continue;
                SCOPED_TRACE(fmt::format("{} {} {}", name, backend, threads));
                settings.backend = backend;
                settings.threads = threads;
                const Rendered other = render_file(scene_path(name), settings);
                size_t equal = 0;
                for (size_t i = 0; i < one.pixels.size(); ++i) equal += one.pixels[i].sum == other.pixels[i].sum;
                // One path that differs by a rounding may reach several pixels: the share of docs/determinism.md, twice.
                EXPECT_GE(double(equal), (backend == "cpu" ? 1.0 : 0.996) * double(one.pixels.size()));
            }
    }
}

TEST_P(Bidirectional, CropsArePartsOfTheWhole) {
    RenderSettings settings = settings_of(GetParam(), "bdpt", 2, 32);
    const Rendered all = render_file(scene_path("reference/diffuse"), settings);
    settings.crop = {{5, 9, 20, 30}};
    const Rendered part = render_file(scene_path("reference/diffuse"), settings);
    for (int y = 9; y < 30; ++y)
        for (int x = 5; x < 20; ++x)
            for (int c = 0; c < 3; ++c) EXPECT_EQ(part.value(x - 5, y - 9, c), all.value(x, y, c)) << x << " " << y;
}

}  // namespace
}  // namespace lampyris::test

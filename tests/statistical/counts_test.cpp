// counts=auto: what the pilot chooses, and that nothing but the scene decides it.
//
// No false alarms: choices are those of fixed seeds, and everything else is the same to the bit.
#include "support/blocks.h"
#include "support/same_image.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <map>
#include <string>

namespace lampyris::test {
namespace {

class Counts : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, Counts, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

RenderRequest request_of(const std::string& scene, const std::string& integrator) {
    RenderRequest request;
    request.scene = SceneSource::of_file(scene_path(scene));
    request.integrator = integrator;
    request.build.resolution = {{24, 24}};
    request.limits.passes = 1;
    return request;
}

std::map<std::string, std::string> choices_of(const RenderOutcome& outcome) {
    return {outcome.record.choices.begin(), outcome.record.choices.end()};
}

// Light that paths from the camera find well, light that they hardly find, and light that only merging finds.
TEST(Counts, SuitTheScene) {
    for (uint32_t seed = 1; seed <= 6; ++seed)
        for (const auto& [scene, integrator, strategies] :
             std::array<std::array<const char*, 3>, 6>{{{"reference/diffuse", "bdpt", "no light paths"},
                                                        {"reference/diffuse", "vcm", "no light paths"},
                                                        {"analytic/lamp-sky", "bdpt", "no light paths"},
                                                        {"reference/slit-bdpt", "bdpt", "connections"},
                                                        {"reference/slit-bdpt", "vcm", "connections"},
                                                        {"reference/sds-pool", "vcm", "merging"}}}) {
            RenderRequest request = request_of(scene, fmt::format("{}:maxdepth=8,counts=auto", integrator));
            request.seed = seed;
            EXPECT_EQ(choices_of(render(request))["strategies"], strategies)
                << scene << " " << integrator << " " << seed;
        }
}

TEST(Counts, GivenOnesStay) {
    auto chosen = choices_of(render(request_of("reference/slit-bdpt", "bdpt:counts=auto,connections=1")));
    EXPECT_EQ(chosen["connections"], "1");
    EXPECT_EQ(chosen["light_paths"], "576");
    chosen = choices_of(render(request_of("reference/diffuse", "bdpt:counts=auto,lightpaths=100")));
    EXPECT_EQ(chosen["connections"], "0");
    EXPECT_EQ(chosen["light_paths"], "100");
    EXPECT_TRUE(choices_of(render(request_of("reference/diffuse", "bdpt"))).empty());
}

TEST(Counts, ThatLeaveNothingToChooseAreRefused) {
    for (const char* settings : {"lightpaths=100,connections=1", "s=1,t=2", "s=1", "strategies=on"})
        EXPECT_THROW(render(request_of("reference/diffuse", fmt::format("bdpt:counts=auto,{}", settings))), InputError)
            << settings;
}

// What is chosen is rendered as if it had been asked for.
TEST_P(Counts, RenderWhatTheyName) {
    for (const auto& [scene, automatic, fixed] :
         std::array<std::array<const char*, 3>, 4>{{{"reference/slit-bdpt", "bdpt", "bdpt"},
                                                    {"reference/diffuse", "bdpt", "path:rrdepth=3"},
                                                    {"reference/slit-bdpt", "vcm", "bdpt"},
                                                    {"reference/dielectric-smooth", "bdpt", "bdpt:connections=0"}}}) {
        if (GetParam() == "vulkan" && automatic == std::string("vcm")) continue;  // the same kernels
        RenderRequest request = request_of(scene, fmt::format("{}:counts=auto", automatic));
        request.backend = GetParam();
        const RenderOutcome chosen = render(request);
        request.integrator = fixed;
        const RenderOutcome asked = render(request);
        for (size_t i = 0; i < asked.pixels.size(); ++i) EXPECT_EQ(chosen.pixels[i].sum, asked.pixels[i].sum) << scene;
        EXPECT_GT(chosen.record.phases.at("pilot"), 0.0);
        EXPECT_GT(chosen.record.counts.at("pilot_rays"), 0.0);
        EXPECT_GT(chosen.record.progress.wall_s, chosen.record.phases.at("pilot"));
    }
}

// ---- The same choice, and image --------------------------------------------------------------------------------------

// One path that differs by a rounding may reach several pixels: the share of docs/determinism.md, twice.
TEST(Counts, SameOnEveryBackendAndThread) {
    expect_same_on_the_cpu("reference/dielectric-smooth", settings_of("cpu", "bdpt:maxdepth=5,counts=auto", 3, 32),
                           0.99);
}

TEST_P(Counts, CropsArePartsOfTheWhole) {
    for (const char* scene : {"reference/diffuse", "reference/dielectric-smooth"})
        if (GetParam() != "vulkan" || scene == std::string("reference/diffuse"))
            expect_crop_is_part_of_the_whole(scene, settings_of(GetParam(), "bdpt:counts=auto", 2, 0));
}

TEST(Counts, DoNotDependOnPassesAndSlices) {
    for (const char* integrator : {"bdpt:counts=auto", "vcm:counts=auto"}) {
        RenderRequest request = request_of("reference/dielectric-smooth", integrator);
        request.limits.passes = 5;
        const RenderOutcome whole = render(request);
        request.max_slice = 1;
        const RenderOutcome sliced = render(request);
        for (size_t i = 0; i < whole.pixels.size(); ++i) EXPECT_EQ(whole.pixels[i].sum, sliced.pixels[i].sum);
        request.limits.passes = 1;
        request.first_pass = 3;
        const RenderOutcome later = render(request);
        constexpr int kX = 11, kY = 14;
        request.replay = {{kX, kY, 3}};
        const RenderOutcome replayed = render(request);
        EXPECT_EQ(replayed.pixels.at(0).sum, later.pixels.at(size_t(kY * 24 + kX)).sum) << integrator;
        EXPECT_EQ(replayed.record.choices, whole.record.choices);
        EXPECT_EQ(later.record.choices, whole.record.choices);
    }
}

}  // namespace
}  // namespace lampyris::test

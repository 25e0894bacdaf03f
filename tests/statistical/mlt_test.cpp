// Metropolis light transport against path tracing, and against itself with other threads, crops and backends.
//
// Pixels of a pass share its brightness, and chains visit neighbours in turn, so the error of a mean comes from renderings with
// different seeds. False alarms: 1e-6 for each scene, at fixed seeds. Power: the tests state it.
#include "support/blocks.h"
#include "support/same_image.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace lampyris::test {
namespace {

class Metropolis : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, Metropolis, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

// Means of the picture's quarters, and of the whole.
constexpr int kParts = 5;
std::array<double, kParts> parts_of(const Rendered& image) {
    const int w = image.width, h = image.height;
    return {block(image, 0, 0, w / 2, h / 2).mean, block(image, w / 2, 0, w, h / 2).mean,
            block(image, 0, h / 2, w / 2, h).mean, block(image, w / 2, h / 2, w, h).mean, whole(image).mean};
}

// Compares the means of parts over `runs` seeds with those of a precise image. `power`: the largest standard error of the whole
// with which the test means something, relative to its mean.
void expect_same_parts(const std::string& scene, RenderSettings settings, uint32_t runs, const Rendered& right,
                       double power) {
    std::array<Mean, kParts> means;
    Rendered last;
    for (uint32_t i = 0; i < runs; ++i) {
        settings.seed = 50 + i;
        last = render_file(scene_path(scene), settings);
        const auto parts = parts_of(last);
        for (size_t k = 0; k < kParts; ++k) means[k].add(parts[k]);
    }
    const auto expected = parts_of(right);
    const int w = right.width, h = right.height;
    const Block of_right = whole(right);
    bool differs = false;
    for (size_t k = 0; k < kParts; ++k) {
        // A quarter has a fourth of the pixels, so at most four times the variance of the whole, if noise is as strong there.
        const Block part =
            k == 4 ? of_right
                   : block(right, k % 2 ? w / 2 : 0, k / 2 ? h / 2 : 0, k % 2 ? w : w / 2, k / 2 ? h : h / 2);
        const double error = std::hypot(means[k].error(), part.error()) + 1e-6;
        const bool same =
            std::abs(means[k].value() - expected[k]) < student_threshold(kAlpha / kParts, runs - 1) * error;
        EXPECT_TRUE(same) << scene << " " << settings.integrator << " " << settings.backend << ", part " << k << ": "
                          << means[k].value() << " +- " << means[k].error() << ", path " << expected[k] << " +- "
                          << part.error();
        differs = differs || !same;
    }
    EXPECT_LT(means[4].error(), power * expected[4] + 1e-6) << scene << ": the test has no power";
    if (differs) {
        save_failure(name_of("mlt " + scene), last.image);
        save_failure(name_of("mlt " + scene + " path"), right.image);
    }
}

class MetropolisScenes : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Scenes, MetropolisScenes, testing::ValuesIn(varied_scenes()),
                         [](const auto& info) { return test_name(info.param); });
INSTANTIATE_TEST_SUITE_P(LongScenes, MetropolisScenes, testing::ValuesIn(further_scenes()),
                         [](const auto& info) { return test_name(info.param); });

TEST_P(MetropolisScenes, AgreeWithPathTracing) {
    const std::string scene = GetParam();
    if (scene == "reference/sds-point" || scene == "reference/sds-pool") return;  // path never finds their light
    RenderSettings settings = settings_of("cpu", "path:maxdepth=6", 512, 16);
    const Rendered path = render_file(scene_path(scene), settings);
    settings.integrator = "mlt:maxdepth=6,mutationsperpixel=32,bootstrapsamples=4096,chains=512,direct=16";
    settings.samples = 2;
    expect_same_parts(scene, settings, 16, path, 0.05);
}

// Chains that start from seeds in proportion to their luminance are at once where they should be: one mutation is as right as many.
TEST_P(Metropolis, IsRightAfterOneMutation) {
    const std::string scene = "reference/diffuse";
    RenderSettings settings = settings_of("cpu", "path:maxdepth=6", 1024, 8);
    const Rendered path = render_file(scene_path(scene), settings);
    settings.backend = GetParam();
    settings.integrator = "mlt:maxdepth=6,mutationsperpixel=8,bootstrapsamples=500,chains=512,direct=16";
    settings.samples = GetParam() == "vulkan" ? 8 : 64;
    expect_same_parts(scene, settings, 16, path, 0.01);
}

TEST_P(Metropolis, StepsChangeNoMean) {
    const std::string scene = "analytic/box-half";
    RenderSettings settings = settings_of("cpu", "path:maxdepth=6", 256, 8);
    const Rendered path = render_file(scene_path(scene), settings);
    settings.backend = GetParam();
    settings.samples = 4;
    for (const char* choice :
         {"largestepprobability=0", "largestepprobability=1", "sigma=0.3", "weights=power", "chains=3"}) {
        settings.integrator = fmt::format("mlt:maxdepth=6,mutationsperpixel=32,bootstrapsamples=2000,{}", choice);
        expect_same_parts(scene, settings, 16, path, 0.02);
    }
}

// A point light in a glass ball, seen through another: neither next-event estimation nor splats nor chance find its light.
TEST_P(Metropolis, FindsWhatOnlyConnectionsDo) {
    const std::string text = R"(
LookAt 0 0 4  0 0 0  0 1 0
Camera "perspective" "float fov" 40
Sampler "independent"
PixelFilter "box"
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
WorldBegin
LightSource "point" "point3 from" [ 0 0 -3 ] "rgb I" [ 10 10 10 ]
Material "dielectric"
AttributeBegin
Translate 0 0 -3
Shape "sphere" "float radius" 0.5
AttributeEnd
AttributeBegin
Translate 0 0 4
Shape "sphere" "float radius" 0.5
AttributeEnd
Material "diffuse" "rgb reflectance" [ 0.8 0.8 0.8 ]
Shape "sphere" "float radius" 20
)";
    constexpr uint32_t kRuns = 16;
    RenderSettings settings = settings_of("cpu", "bdpt:maxdepth=6", 64, 0);
    const Mean right = mean_of_text_runs(text, settings, kRuns);
    settings.backend = GetParam();
    settings.integrator = "mlt:maxdepth=6,mutationsperpixel=32,bootstrapsamples=8000,chains=256";
    settings.samples = 2;
    const Mean found = mean_of_text_runs(text, settings, kRuns);
    const double error = std::hypot(right.error(), found.error());
    EXPECT_LT(std::abs(found.value() - right.value()), student_threshold(kAlpha, kRuns - 1) * error)
        << found.value() << " +- " << found.error() << ", " << right.value() << " +- " << right.error();
    EXPECT_LT(error, 0.1 * right.value()) << "the test has no power";
}

// A pass is one sample of each pixel, and passes are independent: their spread is that of renderings with other seeds.
TEST(Metropolis, PassesTellTheirError) {
    RenderSettings settings = settings_of("cpu", "mlt:maxdepth=6,mutationsperpixel=16,bootstrapsamples=2000", 16, 8);
    Mean estimated, luminance;
    constexpr int kRuns = 48;
    std::vector<Mean> pixels(64);
    for (uint32_t i = 0; i < kRuns; ++i) {
        settings.seed = 200 + i;
        const Rendered image = render_file(scene_path("reference/diffuse"), settings);
        for (int p = 0; p < 64; ++p) {
            estimated.add(image.luminance_variance(p % 8, p / 8));
            pixels[size_t(p)].add(image.luminance(p % 8, p / 8));
        }
    }
    double spread = 0;
    for (const Mean& pixel : pixels) spread += pixel.error() * pixel.error() * kRuns / 64;
    // The relative deviation of a variance from 48 runs of 64 correlated pixels is below 2 / sqrt(48); 5 of these.
    EXPECT_GT(estimated.value() / spread, 0.4);
    EXPECT_LT(estimated.value() / spread, 2.5);
}

// A chain that differs by a rounding goes another way from there on, and reaches many pixels. CPU backends differ at the rims of
// quadrics alone.
TEST(Metropolis, SameOnEveryBackendAndThread) {
    const RenderSettings settings = settings_of("cpu", "mlt:maxdepth=5,chains=1000", 3, 24);
    expect_same_on_every_backend("reference/diffuse", settings, 0.95);
    expect_same_on_the_cpu("reference/dielectric-rough", settings, 0.95);
}

TEST_P(Metropolis, CropsArePartsOfTheWhole) {
    expect_crop_is_part_of_the_whole("reference/diffuse", settings_of(GetParam(), "mlt", 2, 0));
}

TEST_P(Metropolis, DarknessIsBlack) {
    const std::string text = R"(
Camera "perspective"
Film "rgb" "integer xresolution" 4 "integer yresolution" 4
WorldBegin
LightSource "point" "rgb I" [ 0 0 0 ]
Shape "sphere" "float radius" 1
)";
    const Rendered image = render_text(text, settings_of(GetParam(), "mlt", 2, 0));
    for (const kernel::FilmPixel& pixel : image.pixels) EXPECT_EQ(pixel.sum.x, 0.0f);
}

}  // namespace
}  // namespace lampyris::test

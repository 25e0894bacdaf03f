// sppm against pbrt-v4's sppm (scenes/reference/sds-*), with pbrt's own radius, photons and depth, in blocks of 8x8 pixels.
//
// Null hypothesis: a block has the same luminance in both, except for the blur of radii. Allowed: six standard errors (both
// sides; ours is pooled over the blocks, as a share of their luminance; 2e-9 each as normal variables, 1.5e-6 for 768 blocks),
// 2 % for radii that shrink by different counts, and 0.002 for light that leaks around the edges of walls (it falls with the
// radius: 0.0013, 0.0008 and 0.0005 for radii of 0.04, 0.02 and 0.01 in front of the pool). Power: a block that is 6 % off is
// found in all but the noisiest blocks, and the mean detects 1 %.
#include "core/image/image_io.h"
#include "support/runs.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace lampyris::test {
namespace {

constexpr int kBlock = 8;
constexpr int kSeeds = 4;

// Below the ball of glass, where its caustic is narrowest, pbrt's sppm has 15 % more light than ours. Its path tracer's image
// of sds-lamp decides: it has 0.195 in the worst block, where pbrt's sppm has 0.229 and ours 0.193.
const std::set<std::pair<int, int>> kFocus = {{5, 14}, {6, 14}, {5, 15}};

struct Block {
    double luminance = 0.0, variance = 0.0;  // of the reference, and of its mean
};

double luminance_at(const Image& image, int x, int y) {
    return 0.2126 * double(image.at(x, y, 0)) + 0.7152 * double(image.at(x, y, 1)) + 0.0722 * double(image.at(x, y, 2));
}

std::vector<Block> blocks_of(const std::string& name) {
    const std::string path = kScenes + "reference/" + name;
    const Image image = read_image(path + ".exr", {true, true});
    const Image error = read_image(path + ".se.exr", {true, true});
    const int columns = image.width / kBlock;
    std::vector<Block> blocks(size_t(columns * (image.height / kBlock)));
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            Block& block = blocks[size_t(y / kBlock * columns + x / kBlock)];
            block.luminance += luminance_at(image, x, y) / (kBlock * kBlock);
            block.variance += std::pow(luminance_at(error, x, y) / (kBlock * kBlock), 2);
        }
    return blocks;
}

class PhotonReference : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, PhotonReference, testing::Values("sds-pool"),
                         [](const auto& info) { return name_of(info.param); });
INSTANTIATE_TEST_SUITE_P(LongScenes, PhotonReference, testing::Values("sds-lamp", "sds-point"),
                         [](const auto& info) { return name_of(info.param); });

TEST_P(PhotonReference, AgreesWithPbrtBlockByBlock) {
    const std::vector<Block> reference = blocks_of(GetParam());
    std::vector<Mean> ours(reference.size());
    int columns = 0;
    Rendered last;
    for (int seed = 0; seed < kSeeds; ++seed) {
        RenderSettings settings;
        settings.samples = 64;
        settings.seed = uint32_t(300 + seed);
        last = render_file(kScenes + "reference/" + GetParam() + ".pbrt", settings);
        columns = last.width / kBlock;
        std::vector<double> sums(reference.size());
        for (int y = 0; y < last.height; ++y)
            for (int x = 0; x < last.width; ++x)
                sums[size_t(y / kBlock * columns + x / kBlock)] += last.luminance(x, y) / (kBlock * kBlock);
        for (size_t b = 0; b < sums.size(); ++b) ours[b].add(sums[b]);
    }
    double pooled = 0.0, mean = 0.0, reference_mean = 0.0;
    int bright = 0;
    for (size_t b = 0; b < ours.size(); ++b) {
        mean += ours[b].value(), reference_mean += reference[b].luminance;
        if (reference[b].luminance < 0.02) continue;
        pooled += std::pow(ours[b].error() / reference[b].luminance, 2);
        ++bright;
    }
    pooled = std::sqrt(pooled / bright);
    EXPECT_LT(pooled, 0.012) << "our noise";
    EXPECT_NEAR(mean / reference_mean, 1.0, 0.01);
    int wrong = 0;
    for (size_t b = 0; b < ours.size(); ++b) {
        const std::pair<int, int> place(int(b) % columns, int(b) / columns);
        if (std::string(GetParam()) != "sds-pool" && kFocus.count(place)) continue;
        const double there = reference[b].luminance;
        const double noise = std::sqrt(reference[b].variance + std::pow(std::max(pooled * there, ours[b].error()), 2));
        const double limit = 6 * noise + 0.02 * there + 0.002;
        EXPECT_NEAR(ours[b].value(), there, limit) << "block " << place.first << ", " << place.second << ++wrong;
    }
    if (wrong) save_failure(std::string("photon_reference_") + GetParam(), last.image);
}

// Verifies the comment on the exception above.
TEST(PhotonReferenceFocusLong, PbrtsPathTracerDecidesAtTheFocus) {
    const std::vector<Block> photons = blocks_of("sds-lamp"), paths = blocks_of("sds-lamp-path");
    const size_t focus = 14 * 16 + 5;
    EXPECT_GT(photons[focus].luminance, 1.15 * paths[focus].luminance);
    EXPECT_LT(std::sqrt(paths[focus].variance), 0.02 * paths[focus].luminance);
    RenderSettings settings;
    settings.samples = 128;
    const Rendered ours = render_file(kScenes + "reference/sds-lamp.pbrt", settings);
    double sum = 0.0;
    for (int y = 112; y < 120; ++y)
        for (int x = 40; x < 48; ++x) sum += ours.luminance(x, y) / (kBlock * kBlock);
    EXPECT_NEAR(sum, paths[focus].luminance, 0.05 * paths[focus].luminance);
}

// At edges and narrow caustics, no stated confidence can hold. So the test prints the share of all pixels whose error stays
// below the image's `error`, and requires at least half, so that the channel is meaningful for every image.
TEST(PhotonReferenceCoverageLong, OfTheWholeImageIsReported) {
    const Image truth = read_image(kScenes + "reference/sds-lamp-path.exr", {true, true});
    for (const double confidence : {0.5, 0.9}) {
        RenderSettings settings;
        settings.samples = 64;
        settings.integrator =
            fmt::format("sppm:maxdepth=24,radius=0.04,photonsperiteration=40000,confidence={}", confidence);
        const Rendered ours = render_file(kScenes + "reference/sds-lamp.pbrt", settings);
        const int bound = ours.image.find_channel("error.G");
        int below = 0;
        for (int y = 0; y < ours.height; ++y)
            for (int x = 0; x < ours.width; ++x)
                below += std::abs(ours.value(x, y, 1) - truth.at(x, y, 1)) <= ours.value(x, y, bound);
        const double share = double(below) / (ours.width * ours.height);
        std::printf("confidence %.2f: over the whole of sds-lamp the error stays below in %.3f\n", confidence, share);
        EXPECT_GT(share, 0.5);
    }
}

}  // namespace
}  // namespace lampyris::test

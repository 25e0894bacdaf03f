// Path-traced scenes against pbrt-v4's images (scenes/reference): block-wise z-tests of luminance, and means.
//
// Null hypothesis: a block of 8x8 pixels has the same expected luminance in both images. Its z is the difference of means over
// sqrt(se_ref^2 + se_ours^2), with variances pooled over the 64 pixels of the block (448 degrees of freedom on pbrt's side), so
// that heavy tails of single pixels average out. False alarms: per block 2 Phi(-6.5) = 8e-11; 18 scenes x 256 blocks x 3 backends:
// 1.1e-6. The sum of z^2 over the blocks sees small biases that are everywhere: chi-squared with 256 degrees of freedom, tested
// at mean + 7 sigma (below 1e-8 given the skew). Power: at the default number of samples a bias of 2 % in all blocks, or of
// 15 % in a single one, is found nearly always.
#include "core/image/image_io.h"
#include "support/render.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>

namespace lampyris::test {
namespace {

constexpr int kBlock = 8;
constexpr double kBlockLimit = 6.5;

struct ReferenceCase {
    const char* name;
    bool same_model;  // both renderers do the same: z-tests; otherwise only means
    double mean_tolerance;
};

// Differences, and their causes:
// - colour, conductor-gold: pbrt multiplies spectra, Lampyris RGB (3 % per channel).
// - textures: pbrt filters over the pixel's footprint, Lampyris samples the texture at the point.
const ReferenceCase kCases[] = {
    {"diffuse", true, 0.01},           {"conductor-smooth", true, 0.01},
    {"conductor-rough", true, 0.01},   {"dielectric-smooth", true, 0.01},
    {"dielectric-rough", true, 0.01},  {"coated-diffuse", true, 0.01},
    {"thin-dielectric", true, 0.01},   {"diffuse-transmission", true, 0.01},
    {"infinite-constant", true, 0.01}, {"infinite-image", true, 0.01},
    {"point-spot", true, 0.01},        {"distant", true, 0.01},
    {"instances", true, 0.01},         {"thin-lens", true, 0.01},
    {"orthographic", true, 0.01},      {"textures", false, 0.01},
    {"colour", false, 0.03},           {"conductor-gold", false, 0.03},
};

double luminance_at(const Image& image, int x, int y) {
    return 0.2126 * image.at(x, y, 0) + 0.7152 * image.at(x, y, 1) + 0.0722 * image.at(x, y, 2);
}

// The variance of our side is estimated twice: from our samples, and from pbrt's, which are many more, scaled by the ratio of
// sample counts (the number in the scene file is that of all eight runs together; both renderers use the same estimator, except
// for how they choose points on lights). The larger estimate counts: in a caustic, a few dozen samples may have found none of
// the rare bright paths, and would seem to have no noise.
struct BlockSum {
    double difference = 0.0, ours = 0.0, ours_by_reference = 0.0, reference = 0.0;
    double variance() const { return std::max(ours, ours_by_reference) + reference; }
    double z() const { return difference == 0.0 ? 0.0 : difference / std::sqrt(variance()); }
};

class ReferenceTest : public testing::TestWithParam<std::tuple<ReferenceCase, std::string>> {};

TEST_P(ReferenceTest, AgreesWithPbrt) {
    const auto& [scene, backend] = GetParam();
    const std::string directory = std::string(LAMPYRIS_SOURCE_DIR) + "/scenes/reference/";
    RenderSettings settings;
    settings.backend = backend;
    settings.samples = backend == "cpu" ? 64 : 48;
    if (const char* samples = std::getenv("LAMPYRIS_TEST_SAMPLES")) settings.samples = uint32_t(std::atoi(samples));
    settings.seed = 12345;
    const Rendered ours = render_file(directory + scene.name + ".pbrt", settings);
    const Image reference = read_image(directory + scene.name + ".exr", {true, true});
    const Image error = read_image(directory + scene.name + ".se.exr", {true, true});
    ASSERT_EQ(ours.width, reference.width);
    EXPECT_EQ(ours.summary.non_finite, 0u);

    std::array<double, 3> mean{}, reference_mean{};
    std::vector<BlockSum> blocks(size_t(ours.width / kBlock) * size_t(ours.height / kBlock));
    BlockSum whole;
    double reference_total = 0.0;
    for (int y = 0; y < ours.height; ++y) {
        for (int x = 0; x < ours.width; ++x) {
            const double a = ours.luminance(x, y), b = luminance_at(reference, x, y), se = luminance_at(error, x, y);
            const double rounding = b * std::ldexp(1.0, -11) / std::sqrt(3.0);
            for (BlockSum* sum :
                 {&blocks[size_t(y / kBlock) * size_t(ours.width / kBlock) + size_t(x / kBlock)], &whole}) {
                sum->difference += a - b;
                sum->ours += ours.luminance_variance(x, y);
                sum->ours_by_reference += se * se * ours.scene_samples / settings.samples;
                sum->reference += se * se + rounding * rounding;
            }
            reference_total += b;
            for (int c = 0; c < 3; ++c) {
                mean[size_t(c)] += ours.value(x, y, c);
                reference_mean[size_t(c)] += reference.at(x, y, c);
            }
        }
    }
    double chi_squared = 0.0, worst = 0.0;
    Image z_image(ours.width / kBlock, ours.height / kBlock, {"Y"});
    for (size_t i = 0; i < blocks.size(); ++i) {
        const double z = blocks[i].z();
        z_image.pixels[i] = float(z);
        chi_squared += z * z;
        if (std::abs(z) > std::abs(worst)) worst = z;
    }
    fmt::print("{:22} {:9} mean {:+.3f} % (z {:+.2f}), worst block z {:+.2f}, chi2/blocks {:.2f}\n", scene.name,
               backend, whole.difference / reference_total * 100.0, whole.z(), worst,
               chi_squared / double(blocks.size()));
    const double mean_error = std::sqrt(whole.variance()) / reference_total;
    for (size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(mean[c] / reference_mean[c], 1.0, scene.mean_tolerance + 4.0 * mean_error) << "channel " << c;
    if (scene.same_model) {
        EXPECT_LT(std::abs(worst), kBlockLimit);
        EXPECT_LT(chi_squared, double(blocks.size()) + 7.0 * std::sqrt(2.0 * double(blocks.size())));
        EXPECT_LT(std::abs(whole.z()), 6.0);
    }
    if (HasFailure()) {
        const std::string name = std::string("reference_") + scene.name + "_" + backend;
        save_failure(name, ours.image);
        save_failure(name + "_z", z_image);
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, ReferenceTest,
                         testing::Combine(testing::ValuesIn(kCases), testing::ValuesIn(usable_backends())),
                         [](const auto& info) {
                             std::string name =
                                 std::string(std::get<0>(info.param).name) + "_" + std::get<1>(info.param);
                             for (char& c : name) c = c == '-' ? '_' : c;
                             return name;
                         });

}  // namespace
}  // namespace lampyris::test

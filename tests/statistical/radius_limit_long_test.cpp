// As the radius goes to zero, photon mapping converges to path tracing: with fixed radii (alpha = 1), L(r) = L0 + b r^2 is
// fitted to four radii in blocks of 8x8 pixels far from edges, and L0 is compared with path tracing.
//
// A block's variance is taken from eight seeds, pooled over all blocks relative to their radiance (168 degrees of
// freedom). False alarms: |z| > 6.5 in any of 24 blocks: 2e-9; the mean z is tested at 1e-6. Power: a factor of 3 % in
// all blocks shifts the mean z by 2, beyond that.
#include "support/render.h"
#include "support/statistics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace lampyris::test {
namespace {

constexpr int kBlock = 8, kSeeds = 8;
constexpr std::array<double, 4> kRadii{0.03, 0.05, 0.07, 0.09};

struct Estimate {
    double mean = 0.0, variance = 0.0;  // of the mean over seeds
};
using Blocks = std::vector<Estimate>;

Blocks block_means(const std::string& file, const std::string& integrator, uint32_t passes) {
    std::vector<std::vector<double>> runs;
    for (int seed = 0; seed < kSeeds; ++seed) {
        RenderSettings s;
        s.integrator = integrator, s.samples = passes, s.seed = uint32_t(300 + seed), s.sampler = "independent";
        const Rendered image = render_file(file, s);
        std::vector<double> blocks;
        for (int by = 0; by < image.height; by += kBlock)
            for (int bx = 0; bx < image.width; bx += kBlock) {
                double sum = 0.0;
                for (int y = by; y < by + kBlock; ++y)
                    for (int x = bx; x < bx + kBlock; ++x) sum += image.luminance(x, y);
                blocks.push_back(sum / (kBlock * kBlock));
            }
        runs.push_back(std::move(blocks));
    }
    Blocks result(runs[0].size());
    for (size_t b = 0; b < result.size(); ++b) {
        Mean mean;
        for (const auto& run : runs) mean.add(run[b]);
        result[b] = {mean.value(), mean.error() * mean.error()};
    }
    return result;
}

// Blocks around which (within a block's width) all normals are the same and no light is visible: none of their disks crosses an
// edge.
std::vector<size_t> smooth_blocks(const Rendered& image) {
    const int normal = image.image.find_channel("normal.X");
    std::vector<size_t> blocks;
    const int across = image.width / kBlock;
    for (int by = 1; by + 1 < image.height / kBlock; ++by)
        for (int bx = 1; bx + 1 < across; ++bx) {
            bool smooth = true;
            for (int y = (by - 1) * kBlock; y < (by + 2) * kBlock && smooth; ++y)
                for (int x = (bx - 1) * kBlock; x < (bx + 2) * kBlock && smooth; ++x) {
                    for (int c = 0; c < 3; ++c)
                        smooth &= std::abs(image.value(x, y, normal + c) -
                                           image.value(bx * kBlock, by * kBlock, normal + c)) < 1e-3f;
                    smooth &= image.luminance(x, y) < 3.0;
                }
            if (smooth) blocks.push_back(size_t(by) * size_t(across) + size_t(bx));
        }
    return blocks;
}

TEST(RadiusLimit, PhotonMappingTendsToPathTracing) {
    const std::string file = std::string(LAMPYRIS_SOURCE_DIR) + "/scenes/reference/diffuse.pbrt";
    const Blocks path = block_means(file, "path:maxdepth=64", 24);
    std::array<Blocks, 4> photons;
    for (size_t i = 0; i < kRadii.size(); ++i)
        photons[i] = block_means(
            file,
            fmt::format("sppm:schedule=memoryless,alpha=1,maxdepth=64,photonsperiteration=60000,radius={}", kRadii[i]),
            8);
    RenderSettings features;
    features.integrator = "path", features.samples = 16;
    const std::vector<size_t> smooth = smooth_blocks(render_file(file, features));
    ASSERT_GE(smooth.size(), 20u);

    const auto pooled = [&](const Blocks& blocks) {
        double sum = 0.0;
        for (const size_t b : smooth) sum += blocks[b].variance / (blocks[b].mean * blocks[b].mean);
        return sum / double(smooth.size());
    };
    std::array<double, 4> relative{};
    for (size_t i = 0; i < 4; ++i) relative[i] = pooled(photons[i]);
    const double path_relative = pooled(path);

    Mean z_mean;
    double worst = 0.0;
    for (const size_t b : smooth) {
        // Weighted least squares of L0 + b r^2; w = 1 / variance.
        double s = 0.0, sx = 0.0, sxx = 0.0, sy = 0.0, sxy = 0.0;
        for (size_t i = 0; i < 4; ++i) {
            const double x = kRadii[i] * kRadii[i], y = photons[i][b].mean, w = 1.0 / (relative[i] * y * y);
            s += w, sx += w * x, sxx += w * x * x, sy += w * y, sxy += w * x * y;
        }
        const double determinant = s * sxx - sx * sx;
        const double limit = (sxx * sy - sx * sxy) / determinant, variance = sxx / determinant;
        const double z = (limit - path[b].mean) / std::sqrt(variance + path_relative * path[b].mean * path[b].mean);
        worst = std::max(worst, std::abs(z));
        z_mean.add(z);
    }
    EXPECT_LT(worst, 6.5);
    // Neighbouring blocks share photons: the mean of z is only known as well as from the spread of a quarter as many blocks.
    EXPECT_LT(std::abs(z_mean.value()), normal_threshold(1e-6) * 2.0 * z_mean.error());
    RecordProperty("blocks", int(smooth.size()));
    RecordProperty("worst_z", std::to_string(worst));
    RecordProperty("mean_z", std::to_string(z_mean.value()));
    std::printf("%zu blocks, worst |z| %.2f, mean z %.3f +- %.3f, relative errors %.4f (path), %.4f ... %.4f\n",
                smooth.size(), worst, z_mean.value(), z_mean.error(), std::sqrt(path_relative), std::sqrt(relative[0]),
                std::sqrt(relative[3]));
}

}  // namespace
}  // namespace lampyris::test

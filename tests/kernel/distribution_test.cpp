// CDFs of integers on every backend: each interval is found for its own numbers and no others, and its share is their count
// over the total. All of this is exact. Only positions in an interval with a single number are random; their mean has a
// false-alarm rate of 1e-7 per backend.
#include "support/device_run.h"
#include "support/statistics.h"
#include "support/test_scene.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

namespace lampyris::test {
namespace {

using glm::uvec4;
using glm::vec4;

struct Answers {
    std::vector<uvec4> results;
    std::vector<vec4> places;
};

Answers ask(Device& device, const Scene& scene, uvec4 what, const std::vector<uvec4>& inputs) {
    const DeviceSceneHandle on_device = device.upload(scene);
    const KernelHandle kernel = device.compile("kernel/distribution_probe.kernel.h", 0);
    const size_t n = inputs.size();
    const BufferHandle results = device.create_buffer(n * sizeof(uvec4), "results");
    const BufferHandle places = device.create_buffer(n * sizeof(vec4), "places");
    const NamedBuffer buffers[] = {{"probe", upload(device, std::vector{what}, "probe")},
                                   {"inputs", upload(device, inputs, "inputs")},
                                   {"results", results},
                                   {"places", places}};
    device.run(*kernel, on_device.get(), buffers, 0, uint32_t(n));
    return {download<uvec4>(results, n), download<vec4>(places, n)};
}

// Weights over twelve powers of ten, some of them 0.
std::vector<double> weights(size_t count) {
    std::mt19937 rng(5);
    std::uniform_real_distribution<double> exponent(-12.0, 0.0);
    std::vector<double> result(count);
    for (double& w : result) w = rng() % 5 == 0 ? 0.0 : std::pow(10.0, exponent(rng));
    result[count / 2] = 1e4;  // beside it all others are rare
    return result;
}

TEST(Distribution, EveryIntervalIsFoundByItsNumbersAndNoOthers) {
    for (const std::string& backend : kernel_backends()) {
        const auto device = create_device(backend, exact_options(backend));
        for (const size_t count : {size_t(1), size_t(3), size_t(1000), size_t(100000)}) {
            SCOPED_TRACE(backend + ", " + std::to_string(count));
            TestScene scene;
            scene.scene.distributions = {7, 7, 7};
            const uint32_t first = append_cdf(weights(count), scene.scene.distributions);
            const std::vector<uint32_t> cdf(scene.scene.distributions.begin() + first, scene.scene.distributions.end());
            std::vector<uvec4> inputs;
            std::vector<uint32_t> expected;
            for (uint32_t i = 0; i < count; ++i) {
                const uint32_t low = cdf[i], end = cdf[i + 1];
                if (low == end) continue;
                for (const uint32_t number : {low, low + (end - low) / 2, end - 1}) {
                    inputs.push_back({number, 0, 0, 0});
                    expected.push_back(i);
                }
            }
            const Answers answers = ask(*device, scene.finish(), {0, first, count, 0}, inputs);
            size_t wrong = 0;
            for (size_t k = 0; k < inputs.size(); ++k) {
                const uint32_t i = expected[k], low = cdf[i], end = cdf[i + 1];
                const float share = float(double(end - low) / kernel::CDF_TOTAL);
                const float place = std::min(float(inputs[k].x - low) / float(end - low), std::nextafter(1.0f, 0.0f));
                wrong +=
                    answers.results[k] != uvec4(i, std::bit_cast<uint32_t>(share), std::bit_cast<uint32_t>(place), 0);
            }
            EXPECT_EQ(wrong, 0u) << "of " << inputs.size();
        }
    }
}

// The density that weights a sample is that of the sampled texel, to the bit. The position lies in that texel, and is uniform
// in it even if the texel's row, or its column, has a single number.
TEST(Distribution, TexelsAreSampledWithTheirDensity) {
    constexpr uint32_t w = 8, h = 8, kSamples = 4096;
    std::vector<float> picture(w * h, 1.0f);
    for (uint32_t x = 0; x < w; ++x) picture[5 * w + x] = 0.0f;
    picture[1 * w + 1] = 1e12f;
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend, exact_options(backend));
        TestScene scene;
        const uint32_t first = append_image_distribution(picture, w, h, 0.0, scene.scene.distributions);
        const std::vector<uint32_t> table = scene.scene.distributions;
        const uint32_t* rows = table.data() + first;
        ASSERT_EQ(rows[1] - rows[0], 1u);  // the sun's row has all but one number a row
        std::mt19937 rng(9);
        std::vector<uvec4> inputs;
        for (uint32_t i = 0; i < kSamples; ++i) {
            const uint32_t row = std::array{0u, 1u, 7u}[i % 3], column = i % w;
            const uint32_t* columns = rows + h + 1 + row * (w + 1);
            const auto bits = [&](uint32_t low, uint32_t end) {
                return (low + uint32_t(rng() % (end - low))) << 1 | 1u;
            };
            inputs.push_back({bits(columns[column], columns[column + 1]), bits(rows[row], rows[row + 1]), row, column});
        }
        const Answers answers = ask(*device, scene.finish(), {1, first, w, h}, inputs);
        size_t wrong = 0;
        Mean place;
        for (uint32_t i = 0; i < kSamples; ++i) {
            const uint32_t row = inputs[i].z, column = inputs[i].w;
            const uint32_t* columns = rows + h + 1 + row * (w + 1);
            const auto share = [](uint32_t low, uint32_t end) { return float(double(end - low) / kernel::CDF_TOTAL); };
            const float density =
                share(columns[column], columns[column + 1]) * share(rows[row], rows[row + 1]) * float(w * h);
            wrong += answers.results[i] != uvec4(column, row, std::bit_cast<uint32_t>(density), 0);
            const float x = answers.places[i].x * w - float(column), y = answers.places[i].y * h - float(row);
            wrong += !(x >= 0 && x <= 1 && y >= 0 && y <= 1);
            if (row == 0) place.add(double(y));
        }
        EXPECT_EQ(wrong, 0u);
        EXPECT_LT(std::abs(place.value() - 0.5), normal_threshold(1e-7) * place.error());
        EXPECT_NEAR(place.error() * std::sqrt(double(place.count())), std::sqrt(1.0 / 12), 0.02);
    }
}

// The roulette's weight corresponds to how often its number is below the threshold, which is a count of the 2^24 possible
// numbers, over 2^24.
TEST(Distribution, SmallChancesAreMetAsOftenAsTheySay) {
    std::vector<float> chances = {1.0f, 0.5f, 1e-3f, 0x1p-24f, 1e-9f, 1e-30f, 0.999999f};
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend, exact_options(backend));
        TestScene scene;
        scene.scene.distributions = {0};
        std::vector<uvec4> inputs;
        for (const float chance : chances) {
            const auto below = uint32_t(std::ceil(double(chance) * 0x1p24));
            for (const uint32_t number : {below - 1, below})
                inputs.push_back({std::bit_cast<uint32_t>(chance), number << 8, below, number < below ? 1u : 0u});
        }
        const Answers answers = ask(*device, scene.finish(), {2, 0, 0, 0}, inputs);
        for (size_t i = 0; i < inputs.size(); ++i) {
            const float chance = std::bit_cast<float>(answers.results[i].x);
            EXPECT_EQ(double(chance) * 0x1p24, double(inputs[i].z)) << std::bit_cast<float>(inputs[i].x);
            // 2^24 itself does not occur.
            if (inputs[i].z < 1u << 24 || inputs[i].w == 1u) {
                EXPECT_EQ(answers.results[i].y, inputs[i].w) << std::bit_cast<float>(inputs[i].x);
            }
        }
    }
}

}  // namespace
}  // namespace lampyris::test

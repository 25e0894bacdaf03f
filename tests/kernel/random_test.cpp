// Pairs of random numbers that are stratified together (core/kernel/random.h). Nothing is random here: the seed is fixed.
#include "core/device/kernel_types.h"
#include "support/device_run.h"

#include <fmt/format.h>
#include <glm/vec4.hpp>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace lampyris::test {
namespace {

using glm::uvec4;

constexpr uint32_t kGroups = 10;  // those of the table, and two that are shuffled at random

struct Numbers {
    uint32_t samples = 0;
    std::vector<uvec4> all;
    const uvec4& at(uint32_t pixel, uint32_t sample, uint32_t group) const {
        return all[(size_t(pixel) * samples + sample) * kGroups + group];
    }
};

Numbers numbers(uint32_t pixels, uint32_t samples, uint32_t kind = kernel::SAMPLER_SOBOL,
                const std::string& backend = "cpu") {
    const auto device = create_device(backend);
    const uint32_t count = pixels * samples * kGroups;
    const NamedBuffer buffers[] = {
        {"probe", upload(*device, std::vector<uint32_t>{kind, samples, kGroups, 7}, "probe")},
        {"numbers", device->create_buffer(count * sizeof(uvec4), "numbers")}};
    device->run(*device->compile("kernel/random_probe.kernel.h", 0), nullptr, buffers, 0, count);
    return {samples, download<uvec4>(buffers[1].buffer, count)};
}

// Of 2^bits samples that begin at a multiple of their number, each elementary interval of that area has one.
bool is_net(const Numbers& n, uint32_t pixel, uint32_t group, int first, uint32_t begin, int bits) {
    for (int x_bits = 0; x_bits <= bits; ++x_bits) {
        std::vector<bool> taken(size_t(1) << bits);
        for (uint32_t i = begin; i < begin + (1u << bits); ++i) {
            const uvec4& u = n.at(pixel, i, group);
            const uint64_t x = uint64_t(u[first]) >> (32 - x_bits),
                           y = uint64_t(u[first + 1]) >> (32 - (bits - x_bits));
            const size_t interval = size_t(x << (bits - x_bits) | y);
            if (taken[interval]) return false;
            taken[interval] = true;
        }
    }
    return true;
}

TEST(JoinedPairs, AreNets) {
    const Numbers n = numbers(3, 512);
    for (uint32_t pixel = 0; pixel < 3; ++pixel)
        for (uint32_t group = 0; group < kGroups; ++group)
            for (const int first : {0, 2})
                for (int bits = 1; bits <= 9; ++bits)
                    for (uint32_t begin = 0; begin < 512; begin += 1u << bits)
                        ASSERT_TRUE(is_net(n, pixel, group, first, begin, bits))
                            << "group " << group << ", " << (1 << bits) << " samples from " << begin;
}

TEST(JoinedPairs, TheTestOfNetsCanFail) {
    const Numbers independent = numbers(1, 64, kernel::SAMPLER_INDEPENDENT);
    EXPECT_FALSE(is_net(independent, 0, 0, 0, 0, 6));
}

// Over the pixels, any two numbers of one sample are uniform and independent: so is what an image expects of a pixel. 64 cells, chi
// squared of 63 degrees of freedom: above 132 with a probability of 1e-6, for each of 96 pairs.
TEST(JoinedPairs, AreIndependentWithinASample) {
    constexpr uint32_t kPixels = 40'000;
    const Numbers n = numbers(kPixels, 2);
    const auto chi_squared = [&](uint32_t sample, std::array<uint32_t, 2> group, std::array<int, 2> part) {
        std::array<double, 64> cells{};
        for (uint32_t pixel = 0; pixel < kPixels; ++pixel)
            ++cells[(n.at(pixel, sample, group[0])[part[0]] >> 29) * 8 +
                    (n.at(pixel, sample, group[1])[part[1]] >> 29)];
        double sum = 0.0;
        for (const double cell : cells) sum += (cell - kPixels / 64.0) * (cell - kPixels / 64.0) / (kPixels / 64.0);
        return sum;
    };
    double largest = 0.0;
    for (uint32_t group = 0; group < kGroups; ++group)
        for (int a = 0; a < 4; ++a)
            for (int b = a + 1; b < 4; ++b) largest = std::max(largest, chi_squared(1, {group, group}, {a, b}));
    for (uint32_t group = 0; group + 1 < kGroups; ++group)
        for (int a = 0; a < 4; ++a) largest = std::max(largest, chi_squared(1, {group, group + 1}, {a, 3 - a}));
    fmt::print("largest chi squared: {:.1f}\n", largest);
    EXPECT_LT(largest, 132.0);
    EXPECT_GT(chi_squared(1, {0, 0}, {0, 0}), 1e5);  // a number with itself
}

double unit(uint32_t bits) { return double(bits) / 4294967296.0; }

// Of the mean of 64 samples, over pixels; relative to independent samples.
template <typename Integrand>
double variance_gain(const Integrand& of) {
    constexpr uint32_t kPixels = 3000, kSamples = 64;
    double variances[2];
    for (const uint32_t kind : {kernel::SAMPLER_SOBOL, kernel::SAMPLER_INDEPENDENT}) {
        const Numbers n = numbers(kPixels, kSamples, kind);
        double sum = 0.0, squares = 0.0;
        for (uint32_t pixel = 0; pixel < kPixels; ++pixel) {
            double mean = 0.0;
            for (uint32_t i = 0; i < kSamples; ++i) mean += of(n, pixel, i) / kSamples;
            sum += mean, squares += mean * mean;
        }
        variances[kind == kernel::SAMPLER_INDEPENDENT] = squares / kPixels - (sum / kPixels) * (sum / kPixels);
    }
    return variances[0] / variances[1];
}

// What depends on two groups: with a random shuffle between them, as beyond the table, it would be 1 or more.
TEST(JoinedPairs, HaveLessVarianceTogether) {
    const auto together = [](uint32_t group) {
        return variance_gain([group](const Numbers& n, uint32_t pixel, uint32_t i) {
            return (unit(n.at(pixel, i, group).x) - 0.5) * (unit(n.at(pixel, i, group + 1).x) - 0.5);
        });
    };
    double joined = 0.0;
    for (const uint32_t group : {0u, 2u, 4u, 6u}) joined += together(group) / 4.0;
    const double shuffled = together(8);
    fmt::print("variance of a product of numbers of two groups: {:.3f} of that of independent ones, shuffled {:.3f}\n",
               joined, shuffled);
    EXPECT_LT(joined, 0.1);
    EXPECT_GT(shuffled, 0.8);
}

TEST(JoinedPairs, HaveLessVarianceAtEdges) {
    constexpr int kEdges = 8;
    double gain = 0.0;
    for (int edge = 0; edge < kEdges; ++edge)
        gain += variance_gain([edge](const Numbers& n, uint32_t pixel, uint32_t i) {
                    const double angle = 0.7 * edge, offset = 0.1 * (edge % 5) - 0.2;
                    const double x = unit(n.at(pixel, i, 3).x) - 0.5, y = unit(n.at(pixel, i, 3).y) - 0.5;
                    return std::cos(angle) * x + std::sin(angle) * y > offset ? 1.0 : 0.0;
                }) /
                kEdges;
    fmt::print("variance at edges: {:.3f} of that of independent samples\n", gain);
    EXPECT_LT(gain, 0.07);
}

TEST(JoinedPairs, AreTheSameOnEveryBackend) {
    const Numbers expected = numbers(5, 100);
    for (const std::string& backend : kernel_backends())
        EXPECT_EQ(numbers(5, 100, kernel::SAMPLER_SOBOL, backend).all, expected.all) << backend;
}

}  // namespace
}  // namespace lampyris::test

#include "core/scene/filter_table.h"
#include "core/scene/light_distribution.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace lampyris {
namespace {

constexpr uint32_t kTotal = kernel::CDF_TOTAL;
using Tables = std::vector<uint32_t>;

TEST(LightDistribution, CdfsGoFromZeroToTheTotal) {
    Tables tables = {42};
    const std::vector<double> weights = {0, 1, 0, 3, 0, 0};
    EXPECT_EQ(append_cdf(weights, tables), 1u);
    EXPECT_EQ(tables, (Tables{42, 0, 0, kTotal / 4, kTotal / 4, kTotal, kTotal, kTotal}));
}

TEST(LightDistribution, NoWeightAtAllMeansAllAlike) {
    Tables tables;
    append_cdf(std::vector<double>(4, 0.0), tables);
    EXPECT_EQ(tables, (Tables{0, kTotal / 4, kTotal / 2, kTotal / 4 * 3, kTotal}));
}

TEST(LightDistribution, WeightsOfAnyScale) {
    const float big = std::numeric_limits<float>::max();
    Tables tables;
    append_cdf(std::vector<double>(4, 1e300), tables);
    EXPECT_EQ(tables, (Tables{0, kTotal / 4, kTotal / 2, kTotal / 4 * 3, kTotal}));
    tables.clear();
    append_image_distribution(std::vector<float>{big, big, 1e-30f, big}, 2, 2, 0.0, tables);
    EXPECT_NEAR(double(tables[1]), kTotal * 2.0 / 3, 1);
    EXPECT_EQ(tables[2], kTotal);
    EXPECT_EQ(tables[3 + 1], kTotal / 2);
    EXPECT_EQ(tables[6 + 1], 1u);  // a tiny weight is not zero
}

// Exactly: the integers of a CDF are its probabilities, and every positive weight, however small, has at least one.
TEST(LightDistribution, TenMillionWeightsOfAContrastOfABillionAllHaveTheirShare) {
    constexpr size_t kCount = 10'000'000;
    std::vector<double> kinds(1000), weights(kCount);
    for (size_t i = 0; i < kinds.size(); ++i) kinds[i] = i % 7 == 0 ? 0.0 : std::pow(10.0, 9.0 * double(i) / 999.0);
    uint32_t state = 1;
    double sum = 0;
    size_t positive = 0;
    for (double& weight : weights) {
        state = state * 747796405u + 2891336453u;
        weight = kinds[(state >> 8) % 1000];
        sum += weight;
        positive += weight > 0;
    }
    Tables tables;
    append_cdf(weights, tables);
    ASSERT_EQ(tables.size(), kCount + 1);
    EXPECT_EQ(tables.front(), 0u);
    EXPECT_EQ(tables.back(), kTotal);
    size_t lost = 0, given = 0, off = 0;
    for (size_t i = 0; i < kCount; ++i) {
        const uint32_t share = tables[i + 1] - tables[i];
        lost += weights[i] > 0 && share == 0;
        given += weights[i] == 0 && share != 0;
        // Of the integers that are shared by weight, one more or less, because of rounding down.
        off += weights[i] > 0 && std::abs(share - 1.0 - weights[i] / sum * double(kTotal - positive)) > 1.001;
    }
    EXPECT_EQ(lost, 0u);
    EXPECT_EQ(given, 0u);
    EXPECT_EQ(off, 0u);
}

TEST(LightDistribution, RefusesWhatIsNoWeight) {
    Tables tables;
    EXPECT_THROW(append_cdf(std::vector<double>{}, tables), std::invalid_argument);
    EXPECT_THROW(append_cdf(std::vector<double>{1, -1}, tables), std::invalid_argument);
    EXPECT_THROW(append_cdf(std::vector<double>{1, std::nan("")}, tables), std::invalid_argument);
    EXPECT_THROW(append_cdf(std::vector<double>{std::numeric_limits<double>::infinity()}, tables),
                 std::invalid_argument);
    EXPECT_THROW(append_image_distribution(std::vector<float>{1, 1, 1}, 2, 2, 0.0, tables), std::invalid_argument);
}

TEST(LightDistribution, ImagesHaveRowsThenTexels) {
    Tables tables;
    const uint32_t quarter = kTotal / 4, half = kTotal / 2;
    EXPECT_EQ(append_image_distribution(std::vector<float>{1, 3, 0, 0, 6, 6}, 2, 3, 0.0, tables), 0u);
    EXPECT_EQ(tables,
              (Tables{0, quarter, quarter, kTotal, /* rows */ 0, quarter, kTotal, 0, half, kTotal, 0, half, kTotal}));
}

// A sun does not take away the samples of the sky beside it; black texels get none of them.
TEST(LightDistribution, TexelsHaveAShareForAll) {
    Tables tables;
    append_image_distribution(std::vector<float>{1e9f, 1, 0, 1}, 2, 2, kEvenLightShare, tables);
    const double even = kEvenLightShare / 3;
    EXPECT_NEAR(double(kTotal - tables[1]) / kTotal, even, 1e-8);                          // the lower row
    EXPECT_NEAR(double(tables[5] - tables[4]) / kTotal * tables[1] / kTotal, even, 1e-8);  // beside the sun
    EXPECT_EQ(tables[7], 0u);
}

TEST(LightDistribution, LightsAreChosenByPowerWithAShareForAll) {
    Scene scene;
    scene.lights.resize(3);
    choose_lights(scene, std::vector<double>{9, 0, 1});
    EXPECT_EQ(scene.record.light_count, 3u);
    EXPECT_FLOAT_EQ(scene.lights[0].choice_probability, (1 - kEvenLightShare) * 0.9 + kEvenLightShare / 2);
    EXPECT_EQ(scene.lights[1].choice_probability, 0);
    EXPECT_FLOAT_EQ(scene.lights[2].choice_probability, (1 - kEvenLightShare) * 0.1 + kEvenLightShare / 2);
    EXPECT_FLOAT_EQ(scene.lights[0].choice_probability + scene.lights[2].choice_probability, 1);
}

// Powers beyond a float's range still count correctly.
TEST(LightDistribution, LightsOfAnyPowerHaveTheirShare) {
    Scene scene;
    scene.lights.resize(4);
    choose_lights(scene, std::vector<double>{3e60, 1e60, 1e-60, 0});
    const double even = kEvenLightShare / 3;
    EXPECT_FLOAT_EQ(scene.lights[0].choice_probability, (1 - kEvenLightShare) * 0.75 + even);
    EXPECT_FLOAT_EQ(scene.lights[1].choice_probability, (1 - kEvenLightShare) * 0.25 + even);
    EXPECT_FLOAT_EQ(scene.lights[2].choice_probability, even);
    EXPECT_EQ(scene.lights[3].choice_probability, 0);
    EXPECT_EQ(scene.record.light_power, std::numeric_limits<float>::max());
}

TEST(LightDistribution, NoLightsNeedNoTable) {
    Scene scene;
    choose_lights(scene, std::vector<double>{});
    EXPECT_EQ(scene.record.light_count, 0u);
    EXPECT_TRUE(scene.distributions.empty());
}

// Closed forms, and values of the filters that are known.
TEST(FilterTable, FiltersHaveTheirKnownValues) {
    EXPECT_DOUBLE_EQ(gaussian_filter(1.5, 1.5, 0.5), 0);
    EXPECT_DOUBLE_EQ(gaussian_filter(0, 1.5, 0.5), 1 - std::exp(-4.5));
    EXPECT_DOUBLE_EQ(mitchell_filter(0, 2, 1.0 / 3, 1.0 / 3), 8.0 / 9);
    EXPECT_NEAR(mitchell_filter(1, 2, 1.0 / 3, 1.0 / 3), 1.0 / 18, 1e-15);
    EXPECT_NEAR(mitchell_filter(2, 2, 1.0 / 3, 1.0 / 3), 0, 1e-15);
    EXPECT_LT(mitchell_filter(1.4, 2, 1.0 / 3, 1.0 / 3), 0);
    EXPECT_DOUBLE_EQ(sinc_filter(0, 4, 3), 1);
    EXPECT_NEAR(sinc_filter(1, 4, 3), 0, 1e-15);
    EXPECT_LT(sinc_filter(1.5, 4, 3), 0);
    EXPECT_DOUBLE_EQ(sinc_filter(4.1, 4, 3), 0);
}

TEST(FilterTable, IntervalsKeepTheirSignAndTablesFollowEachOther) {
    std::vector<uint32_t> tables(5);
    const auto sinc = [](double x) { return sinc_filter(x, 4, 3); };
    const auto tent = [](double x) { return 1 - x; };
    const uint32_t offset = append_filter_table(sinc, 4, tent, 1, tables);
    EXPECT_EQ(offset, 5u);
    constexpr uint32_t n = kFilterTableSize;
    ASSERT_EQ(tables.size(), 5 + 2 * kFilterTableFloats);
    std::vector<float> numbers;
    for (const uint32_t bits : tables) numbers.push_back(std::bit_cast<float>(bits));
    const float* x = numbers.data() + offset;
    const float* y = x + kFilterTableFloats;
    for (uint32_t i = 0; i < n; ++i) {
        EXPECT_GE(x[i] * x[i + 1], 0);
        EXPECT_LE(x[n + 1 + i], x[n + 2 + i]);
    }
    EXPECT_EQ(x[n + 1], 0);
    EXPECT_EQ(x[2 * n + 1], 1);
    EXPECT_GT(x[2 * n + 2], 1.05);
    EXPECT_EQ(y[2 * n + 2], 1);
    // A tent's CDF from its peak: 1 - (1 - x)^2.
    for (uint32_t i = 0; i <= n; ++i) EXPECT_NEAR(y[n + 1 + i], 1 - std::pow(1 - double(i) / n, 2), 1e-6);
    // The guide never points past a number's interval, and rarely far before it.
    for (const float* table : {x, y}) {
        const float *cdf = table + n + 1, *guide = table + 2 * n + 3;
        for (uint32_t i = 0; i < n; ++i) {
            EXPECT_LE(cdf[uint32_t(guide[i])], float(i) / n);
            EXPECT_GT(cdf[uint32_t(guide[i]) + 1], float(i) / n - 2e-6f);
        }
    }
}

TEST(FilterTable, RefusesAFilterWithoutIntegral) {
    std::vector<uint32_t> tables;
    const auto nothing = [](double) { return 0.0; };
    EXPECT_THROW(append_filter_table(nothing, 1, nothing, 1, tables), std::invalid_argument);
}

}  // namespace
}  // namespace lampyris

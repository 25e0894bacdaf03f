#include "core/scene/filter_table.h"
#include "core/scene/light_distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace lampyris {
namespace {

TEST(LightDistribution, CdfsGoFromZeroToOne) {
    std::vector<float> tables = {42};
    const std::vector<float> weights = {0, 1, 0, 3, 0, 0};
    EXPECT_EQ(append_cdf(weights, tables), 1u);
    const std::vector<float> expected = {42, 0, 0, 0.25f, 0.25f, 1, 1, 1};
    EXPECT_EQ(tables, expected);
}

TEST(LightDistribution, NoWeightAtAllMeansAllAlike) {
    std::vector<float> tables;
    append_cdf(std::vector<float>(4, 0.0f), tables);
    EXPECT_EQ(tables, (std::vector<float>{0, 0.25f, 0.5f, 0.75f, 1}));
}

TEST(LightDistribution, WeightsOfAnyScale) {
    const float big = std::numeric_limits<float>::max();
    std::vector<float> tables;
    append_cdf(std::vector<float>{big, big, big, big}, tables);
    EXPECT_EQ(tables, (std::vector<float>{0, 0.25f, 0.5f, 0.75f, 1}));
    tables.clear();
    append_image_distribution(std::vector<float>{big, big, 1e-30f, big}, 2, 2, tables);
    EXPECT_FLOAT_EQ(tables[1], 2.0f / 3);
    EXPECT_EQ(tables[2], 1);
    EXPECT_EQ(tables[3 + 1], 0.5f);
}

TEST(LightDistribution, RefusesWhatIsNoWeight) {
    std::vector<float> tables;
    EXPECT_THROW(append_cdf(std::vector<float>{}, tables), std::invalid_argument);
    EXPECT_THROW(append_cdf(std::vector<float>{1, -1}, tables), std::invalid_argument);
    EXPECT_THROW(append_cdf(std::vector<float>{1, std::nanf("")}, tables), std::invalid_argument);
    EXPECT_THROW(append_cdf(std::vector<float>{std::numeric_limits<float>::infinity()}, tables), std::invalid_argument);
    EXPECT_THROW(append_image_distribution(std::vector<float>{1, 1, 1}, 2, 2, tables), std::invalid_argument);
}

TEST(LightDistribution, ImagesHaveRowsThenTexels) {
    std::vector<float> tables;
    EXPECT_EQ(append_image_distribution(std::vector<float>{1, 3, 0, 0, 6, 6}, 2, 3, tables), 0u);
    EXPECT_EQ(tables, (std::vector<float>{0, 0.25f, 0.25f, 1, /* rows */ 0, 0.25f, 1, 0, 0.5f, 1, 0, 0.5f, 1}));
}

TEST(LightDistribution, LightsAreChosenByPowerWithAShareForAll) {
    Scene scene;
    scene.lights.resize(3);
    choose_lights(scene, std::vector<float>{9, 0, 1});
    EXPECT_EQ(scene.record.lights.x, 3u);
    EXPECT_FLOAT_EQ(scene.lights[0].emission.w, (1 - kEvenLightShare) * 0.9f + kEvenLightShare / 2);
    EXPECT_EQ(scene.lights[1].emission.w, 0);
    EXPECT_FLOAT_EQ(scene.lights[2].emission.w, (1 - kEvenLightShare) * 0.1f + kEvenLightShare / 2);
    EXPECT_EQ(scene.lights[0].emission.w + scene.lights[1].emission.w + scene.lights[2].emission.w, 1);
}

TEST(LightDistribution, NoLightsNeedNoTable) {
    Scene scene;
    choose_lights(scene, {});
    EXPECT_EQ(scene.record.lights.x, 0u);
    EXPECT_TRUE(scene.distributions.empty());
}

// Closed forms and values at which the filters are known.
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
    std::vector<float> tables(5);
    const auto sinc = [](double x) { return sinc_filter(x, 4, 3); };
    const auto tent = [](double x) { return 1 - x; };
    const uint32_t offset = append_filter_table(sinc, 4, tent, 1, tables);
    EXPECT_EQ(offset, 5u);
    constexpr uint32_t n = kFilterTableSize;
    ASSERT_EQ(tables.size(), 5 + 2 * kFilterTableFloats);
    const float* x = tables.data() + offset;
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
    // The guide never points past a number's interval, and hardly before it.
    for (const float* table : {x, y}) {
        const float *cdf = table + n + 1, *guide = table + 2 * n + 3;
        for (uint32_t i = 0; i < n; ++i) {
            EXPECT_LE(cdf[uint32_t(guide[i])], float(i) / n);
            EXPECT_GT(cdf[uint32_t(guide[i]) + 1], float(i) / n - 2e-6f);
        }
    }
}

TEST(FilterTable, RefusesAFilterWithoutIntegral) {
    std::vector<float> tables;
    const auto nothing = [](double) { return 0.0; };
    EXPECT_THROW(append_filter_table(nothing, 1, nothing, 1, tables), std::invalid_argument);
}

}  // namespace
}  // namespace lampyris

// The cost of the next halving of the error, for histories whose law is known, and whether an estimate can be trusted.
#include "core/render/forecast.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace lampyris {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Points at powers of two and every 50 passes, with an error of 0.5 passes^-exponent and log-normal noise; the seconds of a
// pass are noisy, too.
struct History {
    double exponent, error_noise, time_noise;
    std::mt19937 random;
    double seconds_per_pass = 0.02;

    double normal(double spread) { return spread > 0.0 ? std::normal_distribution<double>(0.0, spread)(random) : 0.0; }
    double error(double passes) { return 0.5 * std::pow(passes, -exponent) * std::exp(normal(error_noise)); }
    std::vector<ErrorPoint> until(uint64_t passes) {
        std::vector<ErrorPoint> points;
        double wall = 0.0;
        for (uint64_t i = 1, last = 0; i <= passes; ++i) {
            if ((i & (i - 1)) != 0 && i % 50 != 0 && i != passes) continue;
            wall += double(i - last) * seconds_per_pass * std::exp(normal(time_noise));
            last = i;
            points.push_back({i, wall, i == 1 ? kNaN : error(double(i))});
        }
        return points;
    }
    // Further seconds until a point has half of the last error of `points`.
    double truth(const std::vector<ErrorPoint>& points) {
        const double noisy_scale = 0.5 * std::exp(normal(error_noise));
        const double passes = std::pow(noisy_scale / (0.5 * points.back().error), 1.0 / exponent);
        return (passes - double(points.back().passes)) * seconds_per_pass * std::exp(normal(time_noise));
    }
};

double coverage(double exponent, ErrorRate rate, double& width, double error_noise = 0.04) {
    // Over 1000 histories, the share has a standard deviation of 0.0095 if the truth is 0.9.
    constexpr int kHistories = 1000;
    int within = 0;
    std::vector<double> ratios;
    for (int i = 0; i < kHistories; ++i) {
        History history{exponent, error_noise, 0.05, std::mt19937(uint32_t(1 + i))};
        const std::vector<ErrorPoint> points = history.until(uint64_t(16 + i));
        const ErrorForecast forecast = forecast_halving(points, rate);
        const double truth = history.truth(points);
        EXPECT_TRUE(std::isfinite(forecast.high_s));
        EXPECT_LT(forecast.low_s, forecast.halving_s);
        EXPECT_LT(forecast.halving_s, forecast.high_s);
        within += forecast.low_s <= truth && truth <= forecast.high_s;
        ratios.push_back(forecast.high_s / forecast.low_s);
    }
    std::nth_element(ratios.begin(), ratios.begin() + kHistories / 2, ratios.end());
    width = ratios[kHistories / 2];
    return double(within) / kHistories;
}

TEST(Forecast, CoversTheTruthAsOftenAsItSays) {
    // Three standard deviations below 0.9: with other seeds, a correct forecast fails once in 700 tests.
    double width = 0.0;
    EXPECT_GE(coverage(1.0, ErrorRate::of_samples(), width), 0.87);
    EXPECT_LT(width, 2.5);
    EXPECT_GE(coverage(2.0 / 3.0, ErrorRate::of_photons(2.0 / 3.0), width), 0.87);
    EXPECT_LT(width, 4.0);
    EXPECT_GE(coverage(0.5, ErrorRate::of_photons(2.0 / 3.0), width), 0.87);
    EXPECT_LT(width, 6.0);
}

// Where the noise of errors is most of the uncertainty: that of the estimate at the end of the history, and that of the one
// in the future. With one of them alone, 0.83 would be covered. The share is 0.904 here: with other seeds, a correct
// forecast fails once in 6000 tests.
TEST(Forecast, CoversTheTruthOfNoisyErrors) {
    double width = 0.0;
    EXPECT_GE(coverage(1.0, ErrorRate::of_samples(), width, 0.08), 0.87);
    EXPECT_LT(width, 3.0);
}

TEST(Forecast, KnowsExactLaws) {
    History samples{1.0, 0.0, 0.0, std::mt19937(1)};
    ErrorForecast forecast = forecast_halving(samples.until(256), ErrorRate::of_samples());
    EXPECT_NEAR(forecast.halving_s, 256 * 0.02, 1e-6);  // as much again
    History photons{0.5, 0.0, 0.0, std::mt19937(1)};
    // Four times the passes halve the error; the prior of 2/3 changes the exponent by a few per cent.
    forecast = forecast_halving(photons.until(256), ErrorRate::of_photons(2.0 / 3.0));
    EXPECT_NEAR(forecast.halving_s, 3 * 256 * 0.02, 0.6);
}

TEST(Forecast, IsNeverSteeperThanTheory) {
    History steep{1.6, 0.0, 0.0, std::mt19937(1)};
    const ErrorForecast forecast = forecast_halving(steep.until(64), ErrorRate::of_samples());
    EXPECT_GE(forecast.halving_s, 64 * 0.02 * 0.999);
}

TEST(Forecast, IsUnknownWithoutHistory) {
    History history{1.0, 0.0, 0.0, std::mt19937(1)};
    for (const uint64_t passes : {1, 2, 4}) {
        const ErrorForecast forecast = forecast_halving(history.until(passes), ErrorRate::of_samples());
        EXPECT_TRUE(std::isnan(forecast.halving_s) && std::isnan(forecast.low_s) && std::isnan(forecast.high_s));
    }
    EXPECT_TRUE(std::isfinite(forecast_halving(history.until(8), ErrorRate::of_samples()).high_s));
    EXPECT_TRUE(std::isnan(forecast_halving({}, ErrorRate::of_samples()).low_s));
    // No variance: nothing to halve.
    const std::vector<ErrorPoint> flat{{1, 1, 0}, {2, 2, 0}, {4, 4, 0}, {8, 8, 0}};
    EXPECT_TRUE(std::isnan(forecast_halving(flat, ErrorRate::of_samples()).low_s));
}

TEST(Forecast, SaysThatAnErrorThatStaysMayNeverHalve) {
    History bias{0.05, 0.0, 0.0, std::mt19937(1)};
    ErrorForecast forecast = forecast_halving(bias.until(256), ErrorRate::of_photons(1.0));
    EXPECT_TRUE(std::isnan(forecast.high_s));
    EXPECT_GT(forecast.low_s, 256 * 0.02);
    History rising{-0.5, 0.0, 0.0, std::mt19937(1)};
    forecast = forecast_halving(rising.until(256), ErrorRate::of_samples());
    EXPECT_TRUE(std::isnan(forecast.halving_s) && std::isnan(forecast.high_s));
}

TEST(Forecast, TellsWhyAnEstimateIsUnstable) {
    const ErrorRate samples = ErrorRate::of_samples(), photons = ErrorRate::of_photons(2.0 / 3.0);
    History good{1.0, 0.0, 0.0, std::mt19937(1)};
    const std::vector<ErrorPoint> falls = good.until(64);
    EXPECT_EQ(why_unstable({64, 0.02, 0.0}, falls, samples), "");
    EXPECT_EQ(why_unstable({1, 0.02, 0.0}, {}, samples), "only 1 sample in a pixel");
    EXPECT_EQ(why_unstable({7, 0.02, 0.0}, falls, samples), "only 7 samples in a pixel");
    EXPECT_EQ(why_unstable({8, 0.02, 0.0}, falls, samples), "");
    EXPECT_EQ(why_unstable({64, 0.02, 0.5}, falls, samples), "50 % of the surfaces in sight have no light yet");
    EXPECT_EQ(why_unstable({64, 0.6, 0.0}, falls, samples), "0.1 % of the pixels make 60 % of it");
    // As passes^-0.25: for the mean of samples, this means that the measured variance still grows; for photon maps, theory
    // predicts it.
    History slow{0.25, 0.0, 0.0, std::mt19937(1)};
    const std::vector<ErrorPoint> slows = slow.until(64);
    EXPECT_EQ(why_unstable({64, 0.02, 0.0}, slows, samples), "the variance seen is 1.7 times that at half the passes");
    EXPECT_EQ(why_unstable({64, 0.02, 0.0}, slows, photons), "");
}

}  // namespace
}  // namespace lampyris

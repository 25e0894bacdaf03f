#include "core/render/forecast.h"

#include "core/base/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

namespace lampyris {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kFastest = 1.0;  // no integrator here converges faster than the mean of independent samples

// Assumptions before a run has shown anything.
constexpr double kRateSpread = 0.25;  // standard deviation of the exponent around the expected one
constexpr double kNoise = 0.06;       // of the logarithm of an error
constexpr double kNoiseWeight = 4.0;  // the prior counts as much as this many points
constexpr double kRateDrift = 0.1;    // of the exponent between the fitted history and the next halving
constexpr double kTimeSpread = 0.05;  // of the logarithm of a pass's seconds
constexpr double kWindow = 6.0;       // the passes from 1/6 of all on are fitted: about three powers of two
constexpr double kStep = 1.18920711;  // 2^(1/4): points that are closer together add no information
constexpr size_t kFewestPoints = 3;
constexpr uint64_t kFewestPasses = 8;
constexpr uint64_t kEarlyPasses =
    16;  // before that, errors fall faster or slower than later: radii and variances settle

// 95 % quantile of Student's t: the Cornish-Fisher expansion about the normal distribution's.
double t_quantile(double freedom) {
    constexpr double z = 1.6448536;
    constexpr double z3 = z * z * z, z5 = z3 * z * z;
    return z + (z3 + z) / (4.0 * freedom) + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * freedom * freedom);
}

bool known(const ErrorPoint& point) { return std::isfinite(point.error) && point.error > 0.0 && point.passes > 0; }

// The recent history, thinned to equal steps of the logarithm of passes, most recent point first.
std::vector<ErrorPoint> recent(std::span<const ErrorPoint> history) {
    std::vector<ErrorPoint> points;
    if (history.empty()) return points;
    const double first = double(history.back().passes) / kWindow;
    for (size_t i = history.size(); i-- > 0;) {
        const ErrorPoint& point = history[i];
        if (double(point.passes) < first || !known(point)) break;
        if (points.empty() || double(point.passes) * kStep <= double(points.back().passes)) points.push_back(point);
    }
    return points;
}

struct Line {
    double exponent, exponent_variance, noise_variance, quantile;
};

// Least squares of log error over log passes, with the expected exponent and noise as conjugate prior.
Line fit(const std::vector<ErrorPoint>& points, double expected) {
    const double n = double(points.size());
    double mean_x = 0.0, mean_y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    for (const ErrorPoint& p : points) {
        mean_x += std::log(double(p.passes)) / n;
        mean_y += std::log(p.error) / n;
    }
    for (const ErrorPoint& p : points) {
        const double x = std::log(double(p.passes)) - mean_x, y = std::log(p.error) - mean_y;
        xx += x * x;
        xy += x * y;
        yy += y * y;
    }
    const double weight = kNoise * kNoise / (kRateSpread * kRateSpread);
    const double slope = (xy - weight * expected) / (xx + weight);
    const double residual = yy + weight * expected * expected - slope * slope * (xx + weight);
    const double freedom = kNoiseWeight + n - 1.0;
    const double noise = (kNoiseWeight * kNoise * kNoise + std::max(0.0, residual)) / freedom;
    return {-slope, noise / (xx + weight) + kRateDrift * kRateDrift, noise, t_quantile(freedom)};
}

struct PassTime {
    double seconds, log_spread;
};

PassTime pass_time(const std::vector<ErrorPoint>& points) {
    const ErrorPoint &now = points.front(), &then = points.back();
    const double passes = double(now.passes - then.passes);
    const double seconds = (now.wall_s - then.wall_s) / passes;
    double variance = 0.0;
    for (size_t i = 0; i + 1 < points.size(); ++i) {
        const double share = double(points[i].passes - points[i + 1].passes);
        const double off = (points[i].wall_s - points[i + 1].wall_s) / (share * seconds) - 1.0;
        variance += share / passes * off * off;
    }
    return {seconds, std::sqrt(kTimeSpread * kTimeSpread + variance)};
}

// The growth of the error since half of the passes, relative to the decrease that theory predicts; empty if it is not known.
std::optional<double> growth(std::span<const ErrorPoint> history, ErrorRate rate) {
    if (history.empty() || !known(history.back())) return {};
    const ErrorPoint& now = history.back();
    for (size_t i = history.size(); i-- > 0;) {
        const ErrorPoint& then = history[i];
        if (then.passes * 2 > now.passes) continue;
        if (!known(then)) return {};
        return now.error / then.error * std::pow(double(now.passes) / double(then.passes), rate.slowest);
    }
    return {};
}

}  // namespace

ErrorForecast forecast_halving(std::span<const ErrorPoint> history, ErrorRate rate) {
    ErrorForecast result{kUnknown, kUnknown, kUnknown};
    const std::vector<ErrorPoint> points = recent(history);
    if (points.size() < kFewestPoints || points.front().passes < kFewestPasses) return result;
    const PassTime pass = pass_time(points);
    if (!(pass.seconds > 0.0)) return result;
    const Line line = fit(points, rate.expected);
    // After passes * e^d, the logarithm of the error has fallen by exponent * d. Its uncertainty is the exponent's spread times
    // d, plus the noise of the present estimate and of the future one. The interval holds every d for which log 2 is within
    // that uncertainty (Fieller's interval).
    const double q = line.quantile, s = std::min(line.exponent, kFastest), drop = std::numbers::ln2;
    const double noise = 2.0 * q * q * line.noise_variance;
    const double a = s * s - q * q * line.exponent_variance, c = drop * drop - noise;
    const double root = std::sqrt(std::max(0.0, s * s * drop * drop - a * c));
    const double passes = double(points.front().passes), time_spread = q * pass.log_spread;
    const double falls = s * drop + root;
    if (!(s > 0.0 && c > 0.0)) return result;  // the error rises, or is nothing but noise
    // While the fitted history still has few samples, its error estimates tend to grow: the true error falls faster than they
    // do.
    const double d_fastest = (drop - std::sqrt(noise)) / kFastest;
    const double d_low = points.back().passes < kEarlyPasses ? d_fastest : std::max(c / falls, d_fastest);
    // The time of a pass is independent of the number of passes, so the variances of their logarithms add.
    const auto apart = [&](double from, double to) {
        const double passes_spread = std::log(std::expm1(to) / std::expm1(from));
        return std::sqrt(passes_spread * passes_spread + time_spread * time_spread);
    };
    const double d = drop / s;
    result.halving_s = passes * std::expm1(d) * pass.seconds;
    result.low_s = result.halving_s * std::exp(-apart(d_low, d));
    if (a > 0.0) result.high_s = result.halving_s * std::exp(apart(d, falls / a));
    if (!std::isfinite(result.halving_s)) result.halving_s = kUnknown;
    if (!std::isfinite(result.high_s)) result.high_s = kUnknown;
    return result;
}

std::string why_unstable(const EstimateHealth& health, std::span<const ErrorPoint> history, ErrorRate rate) {
    constexpr double kDark = 0.02, kLargest = 0.5, kGrowth = 1.5;
    if (health.min_samples < kTrustedSamples)
        return fmt::format("only {} in a pixel", counted(health.min_samples, "sample"));
    if (health.dark_share > kDark)
        return fmt::format("{:.0f} % of the surfaces in sight have no light yet", 100.0 * health.dark_share);
    if (health.largest_share > kLargest)
        return fmt::format("0.1 % of the pixels make {:.0f} % of it", 100.0 * health.largest_share);
    if (const std::optional<double> grown = growth(history, rate); grown && *grown > kGrowth)
        return fmt::format("the variance seen is {:.2g} times that at half the passes", *grown);
    return {};
}

}  // namespace lampyris

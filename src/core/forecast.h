// What the next halving of the estimated error costs, from a rendering's own history, and whether the estimate can be
// trusted. docs/stats.md has the formulas.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace lampyris {

// One look at a rendering: after `passes` passes and `wall_s` seconds its estimated relMSE was `error` (NaN: not known).
struct ErrorPoint {
    uint64_t passes = 0;
    double wall_s = 0.0, error = 0.0;
};

// How fast theory lets an integrator's error fall: as passes^-exponent.
struct ErrorRate {
    double expected = 1.0;  // 1 for the mean of independent samples
    double slowest = 1.0;   // as slow as that, and the estimate is still what theory says

    static ErrorRate of_samples() { return {1.0, 1.0}; }
    // Radii that keep the share `alpha` of new photons: variance falls as passes^-alpha (Kaplanyan and Dachsbacher 2013),
    // the squared bias at edges as passes^(-(1 - alpha) / 2).
    static ErrorRate of_photons(double alpha) { return {alpha, 0.5 * (1.0 - alpha)}; }
};

// Further seconds of rendering until the estimated error has halved; NaN where that is not known.
struct ErrorForecast {
    static constexpr double kConfidence = 0.9;  // that the truth lies between low_s and high_s
    double halving_s, low_s, high_s;            // high_s: NaN beside a known low_s where it may never halve
};

// `history` by increasing passes, the last one now.
ErrorForecast forecast_halving(std::span<const ErrorPoint> history, ErrorRate rate);

// With fewer samples of a pixel no estimate is trusted.
constexpr uint32_t kTrustedSamples = 8;

// Of all pixels' estimates: what tells whether the sum can be trusted.
struct EstimateHealth {
    uint32_t min_samples = 0;    // of a pixel
    double largest_share = 0.0;  // of the estimate, by the 0.1 % of the pixels where it is largest
    double dark_share = 0.0;     // of the pixels that see a surface that is not black: those without light in sight
};

// Why the estimate is unstable, in a few words; empty where nothing speaks against it. What no sample has met, nothing shows;
// what all passes share, neither: Integrator::unseen_error tells of that.
std::string why_unstable(const EstimateHealth& health, std::span<const ErrorPoint> history, ErrorRate rate);

}  // namespace lampyris

// Predicts the cost of the next halving of the estimated error, from a rendering's own history, and decides whether the
// estimate can be trusted. docs/stats.md has the formulas.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace lampyris {

// The state at one moment: after `passes` passes and `wall_s` seconds the estimated relMSE was `error` (NaN: not known).
struct ErrorPoint {
    uint64_t passes = 0;
    double wall_s = 0.0, error = 0.0;
};

// How fast an integrator's error falls in theory: as passes^-exponent.
struct ErrorRate {
    double expected = 1.0;  // 1 for the mean of independent samples
    double slowest = 1.0;   // down to this exponent, the estimate agrees with theory

    static ErrorRate of_samples() { return {1.0, 1.0}; }
    // For photons whose radii keep the share `alpha` of new photons: variance falls as passes^-alpha (Kaplanyan and Dachsbacher
    // 2013), the squared bias at edges as passes^(-(1 - alpha) / 2).
    static ErrorRate of_photons(double alpha) { return {alpha, 0.5 * (1.0 - alpha)}; }
};

// Further seconds of rendering until the estimated error has halved; NaN if not known.
struct ErrorForecast {
    static constexpr double kConfidence = 0.9;  // that the truth lies between low_s and high_s
    double halving_s, low_s, high_s;            // high_s is NaN beside a known low_s if the error may never halve
};

// `history` is in order of increasing passes; its last point is the present one.
ErrorForecast forecast_halving(std::span<const ErrorPoint> history, ErrorRate rate);

// With fewer samples per pixel no estimate is trusted.
constexpr uint32_t kTrustedSamples = 8;

// Properties of all pixels' estimates that show whether their sum can be trusted.
struct EstimateHealth {
    uint32_t min_samples = 0;    // of a pixel
    double largest_share = 0.0;  // of the estimate, by the 0.1 % of the pixels where it is largest
    double dark_share = 0.0;     // of the pixels with a surface (not black): those without light in or around them
};

// Why the estimate is unstable, in a few words; empty if nothing speaks against it. Light that no sample has found cannot show
// here, and neither can an error that all passes share, which Integrator::unseen_error reports.
std::string why_unstable(const EstimateHealth& health, std::span<const ErrorPoint> history, ErrorRate rate);

}  // namespace lampyris

// How far an image is from its reference. docs/metrics.md says when to look at which number.
#pragma once

#include "core/image/flip.h"
#include "core/image/image.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lampyris {

// All sums are in double precision and in a fixed order. I is the image, R the reference; a mean is over pixels and
// channels. A pixel with NaN or Inf in any channel of either image is left out of every number here but `non_finite`;
// where no pixel is left, the numbers are NaN.
struct Metrics {
    double mse = 0.0, rmse = 0.0, relmse = 0.0, relmse_trimmed = 0.0, mape = 0.0, smape = 0.0;
    std::array<double, 3> mean{}, reference_mean{};  // of R, G and B
    uint64_t pixels = 0;                             // that were compared
    uint64_t non_finite = 0;                         // that were left out
};

struct MetricFormula {
    const char* key;   // in JSON
    const char* name;  // for people
    const char* formula;
    double Metrics::*value;
};
// Every number of Metrics that is a distance, in the order in which it is shown: the one list behind tables, JSON and
// statistics.
const std::vector<MetricFormula>& metric_formulas();

// The share of pixels with the largest relative squared error that relmse_trimmed leaves out.
inline constexpr double kTrimmedShare = 0.001;

// For convergence statistics: a few passes over the pixels. Both spans are [pixels][3].
// Throws InputError where their sizes differ or are not a multiple of three.
Metrics measure(std::span<const float> image, std::span<const float> reference);
// Throws InputError that names both sizes where they differ.
void check_same_size(const Image& image, const Image& reference);
// Compares R, G, B. Throws InputError that names both sizes where they differ.
Metrics measure(const Image& image, const Image& reference);

// Everything that `lampyris compare` tells.
struct Comparison {
    Metrics metrics;
    int width = 0, height = 0;
    bool hdr = true;  // HDR-FLIP; LDR-FLIP where one of the files holds integers
    FlipResult flip;  // the error of a pixel that was left out is NaN, and the mean is without it
};
Comparison compare_images(const Image& image, const Image& reference);

// FLIP's error in magma's colours, [height][width][3]; left-out pixels are green, which magma has not.
std::vector<uint8_t> error_picture(const Comparison& comparison);

}  // namespace lampyris

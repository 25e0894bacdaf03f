// How far an image is from its reference. docs/metrics.md says which number to use when.
#pragma once

#include "core/image/flip.h"
#include "core/image/image.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lampyris {

// All sums are in double precision and in a fixed order. I is the image, R the reference; a mean is over pixels and channels. A
// pixel with NaN or Inf in any channel of either image is excluded from every number here but `non_finite`; if no pixel
// remains, the numbers are NaN.
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
// Every number of Metrics that is a distance, in display order: tables, JSON and statistics all use this list.
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

// Everything that `lampyris compare` reports.
struct Comparison {
    Metrics metrics;
    int width = 0, height = 0;
    bool hdr = true;  // LDR-FLIP if one of the files holds integers, otherwise HDR-FLIP
    FlipResult flip;  // a left-out pixel has the error NaN, and is excluded from the mean
};
Comparison compare_images(const Image& image, const Image& reference);

// FLIP's error in magma's colours, [height][width][3]; left-out pixels are green, which magma has not.
std::vector<uint8_t> error_picture(const Comparison& comparison);

}  // namespace lampyris

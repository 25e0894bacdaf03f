// The relMSE of a picture without a reference, as predicted by its pixels' own variance. docs/stats.md has the formula.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

namespace lampyris {

struct ChannelEstimate {
    double mean = 0.0, variance = 0.0;  // variance of the mean; NaN below two samples
};

// The current estimate of a pixel, by channel.
struct PixelEstimate {
    std::array<ChannelEstimate, 3> radiance;
    std::array<double, 3> bias_squared{};  // estimated; right on average, but single ones may be negative
    bool left_out = false;                 // no sample was finite: the pixel is excluded from all sums
    bool unknown = false;                  // its variance or bias is beyond the range of a float
    bool sees_surface = false;             // with an albedo above 0
    bool has_light = false;
};

struct ErrorEstimate {
    double relmse = 0.0;         // NaN if a pixel has fewer than two samples, or its error is unknown
    uint64_t unknown = 0;        // pixels whose error is unknown
    double largest_share = 0.0;  // of relmse, by the 0.1 % of the pixels where it is largest
    double dark_share = 0.0;     // of the pixels with a surface (not black): those without light in or around them
};

using PixelReader = std::function<PixelEstimate(uint32_t x, uint32_t y)>;

// Reads each pixel once, row by row.
ErrorEstimate estimate_error(uint32_t width, uint32_t height, const PixelReader& read);

}  // namespace lampyris

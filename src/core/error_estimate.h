// relMSE of a picture that has no reference: what its pixels' own variance predicts. docs/stats.md has the formula.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

namespace lampyris {

struct ChannelEstimate {
    double mean = 0.0, variance = 0.0;  // variance of the mean; NaN below two samples
};

// What is known of a pixel, by channel.
struct PixelEstimate {
    std::array<ChannelEstimate, 3> radiance;
    std::array<double, 3> bias_squared{};  // estimated; the mean of many is right, single ones may be negative
    bool left_out = false;                 // no sample was finite: it counts nowhere
    bool unknown = false;                  // its variance or bias is beyond the range of a float
    bool sees_surface = false;             // with an albedo above 0
    bool has_light = false;
};

struct ErrorEstimate {
    double relmse = 0.0;         // NaN where a pixel has less than two samples, or its error is unknown
    uint64_t unknown = 0;        // pixels whose error is
    double largest_share = 0.0;  // of relmse, by the 0.1 % of the pixels where it is largest
    double dark_share = 0.0;     // of the pixels that see a surface: those without light in themselves and around them
};

using PixelReader = std::function<PixelEstimate(uint32_t x, uint32_t y)>;

// Reads each pixel once, row by row.
ErrorEstimate estimate_error(uint32_t width, uint32_t height, const PixelReader& read);

}  // namespace lampyris

#include "core/render/error_estimate.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace lampyris {
namespace {

constexpr uint32_t kReach = 2;             // neighbours are the other pixels of 5 x 5
constexpr double kTrustedVariance = 0.25;  // of a mean over its square: from here on, the mean itself is ignored

// The share of a sum that comes from the largest 0.1 % of its terms; 0 if the sum is not known, or zero.
double share_of_largest(std::vector<float> terms) {
    double sum = 0.0, largest = 0.0;
    for (const float term : terms) sum += double(term);
    if (!(sum > 0.0)) return 0.0;
    const size_t count = (terms.size() + 999) / 1000;
    std::nth_element(terms.begin(), terms.begin() + ptrdiff_t(count - 1), terms.end(), std::greater<>());
    for (size_t i = 0; i < count; ++i) largest += double(terms[i]);
    return largest / sum;
}

// Sums over pixels: of a column of the square, or of the whole square.
struct Sums {
    std::array<double, 3> radiance{};
    uint32_t pixels = 0, lit = 0;

    void add(const Sums& other) {
        for (size_t c = 0; c < 3; ++c) radiance[c] += other.radiance[c];
        pixels += other.pixels;
        lit += other.lit;
    }
    static Sums of(const PixelEstimate& pixel) {
        Sums sums;
        if (pixel.left_out) return sums;
        for (size_t c = 0; c < 3; ++c) sums.radiance[c] = std::abs(pixel.radiance[c].mean);
        sums.pixels = 1;
        sums.lit = pixel.has_light;
        return sums;
    }
};

// The denominator of relMSE, R^2 + 0.01. A firefly makes a pixel's own mean large together with its variance, so that the
// relative error seems small although the true mean R is not large. The less certain the pixel's mean, the more the mean of its
// neighbours replaces it.
double denominator(const ChannelEstimate& own, double neighbours) {
    const double mean = std::abs(own.mean);
    double r = mean;
    if (neighbours < mean) {
        const double share = std::min(1.0, own.variance / (mean * mean) / kTrustedVariance);
        r = (1.0 - share) * mean + share * neighbours;
    }
    return r * r + 0.01;
}

// The rows that the current square needs.
class Rows {
 public:
    Rows(uint32_t width, uint32_t height, const PixelReader& read) : width_(width), height_(height), read_(read) {
        pixels_.resize(size_t(kRows) * width);
        columns_.resize(width);
    }
    // Makes row y the middle one; must be called for 0, 1, 2, ... in order.
    void move_to(uint32_t y) {
        const uint32_t end = std::min(height_, y + kReach + 1);
        for (; read_rows_ < end; ++read_rows_)
            for (uint32_t x = 0; x < width_; ++x) pixel(x, read_rows_) = read_(x, read_rows_);
        for (uint32_t x = 0; x < width_; ++x) {
            columns_[x] = {};
            for (uint32_t row = y - std::min(y, kReach); row < end; ++row) columns_[x].add(Sums::of(pixel(x, row)));
        }
    }
    PixelEstimate& pixel(uint32_t x, uint32_t y) { return pixels_[size_t(y % kRows) * width_ + x]; }
    // The sum over the square around pixel x of the middle row y, without that pixel. (Subtracting the pixel from a complete
    // sum would leave its rounding error.)
    Sums around(uint32_t x, uint32_t y) {
        Sums sums;
        for (uint32_t i = x - std::min(x, kReach); i < std::min(width_, x + kReach + 1); ++i)
            if (i != x) sums.add(columns_[i]);
        for (uint32_t row = y - std::min(y, kReach); row < std::min(height_, y + kReach + 1); ++row)
            if (row != y) sums.add(Sums::of(pixel(x, row)));
        return sums;
    }

 private:
    static constexpr uint32_t kRows = 2 * kReach + 1;
    const uint32_t width_, height_;
    const PixelReader& read_;
    uint32_t read_rows_ = 0;
    std::vector<PixelEstimate> pixels_;
    std::vector<Sums> columns_;
};

}  // namespace

ErrorEstimate estimate_error(uint32_t width, uint32_t height, const PixelReader& read) {
    ErrorEstimate result;
    Rows rows(width, height, read);
    double error = 0.0, bias_squared = 0.0;
    uint64_t surfaces = 0, dark = 0;
    std::vector<float> errors;
    errors.reserve(size_t(width) * height);
    for (uint32_t y = 0; y < height; ++y) {
        rows.move_to(y);
        for (uint32_t x = 0; x < width; ++x) {
            const PixelEstimate& pixel = rows.pixel(x, y);
            if (pixel.left_out) continue;
            result.unknown += pixel.unknown;
            const Sums around = rows.around(x, y);
            double of_pixel = 0.0;
            for (size_t c = 0; c < 3; ++c) {
                const ChannelEstimate& own = pixel.radiance[c];
                const double neighbours =
                    around.pixels > 0 ? around.radiance[c] / double(around.pixels) : std::abs(own.mean);
                const double divisor = denominator(own, neighbours);
                of_pixel += own.variance / divisor;
                bias_squared += pixel.bias_squared[c] / divisor;
            }
            error += of_pixel;
            errors.push_back(float(std::min(of_pixel, double(std::numeric_limits<float>::max()))));
            surfaces += pixel.sees_surface;
            dark += pixel.sees_surface && !pixel.has_light && around.lit == 0;
        }
    }
    if (bias_squared > 0.0) error += bias_squared;
    result.relmse =
        result.unknown > 0 ? std::numeric_limits<double>::quiet_NaN() : error / (3.0 * double(errors.size()));
    result.dark_share = surfaces > 0 ? double(dark) / double(surfaces) : 0.0;
    result.largest_share = share_of_largest(std::move(errors));
    return result;
}

}  // namespace lampyris

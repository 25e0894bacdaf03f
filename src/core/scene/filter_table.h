// Tables from which kernels sample smooth pixel filters (core/kernel/camera.h); their layout is in core/kernel/layout.h.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace lampyris {

// Intervals of a table between the pixel's centre and the filter's radius: linear interpolation is then within 0.1 % of
// the filter's peak, also for the lobes of a sinc of radius 4.
inline constexpr uint32_t kFilterTableSize = 128;
// Number of 32-bit words per axis: nodes, CDF, the ratio of the integrals of |filter| and filter, guide.
inline constexpr uint32_t kFilterTableFloats = 3 * kFilterTableSize + 3;

// The filters of pbrt-v4 (4th edition, section 8.8), by the distance x from the centre in pixels; not normalised.
double gaussian_filter(double x, double radius, double sigma);
double mitchell_filter(double x, double radius, double b, double c);
double sinc_filter(double x, double radius, double tau);  // sinc windowed by the first lobe of a wider sinc (Lanczos)

// Appends the tables of a separable filter x_filter(x) y_filter(y), both even, and returns their offset; they have
// kFilterTableSize intervals each. Throws std::invalid_argument if a filter's integral is not positive.
uint32_t append_filter_table(const std::function<double(double)>& x_filter, double x_radius,
                             const std::function<double(double)>& y_filter, double y_radius,
                             std::vector<uint32_t>& distributions);

}  // namespace lampyris

#include "core/scene/filter_table.h"

#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace lampyris {
namespace {

double sinc(double x) {
    const double y = std::numbers::pi * x;
    return std::abs(y) < 1e-5 ? 1.0 : std::sin(y) / y;
}

void append_axis(const std::function<double(double)>& filter, double radius, std::vector<uint32_t>& distributions) {
    constexpr uint32_t n = kFilterTableSize;
    std::vector<double> node(n + 1);
    for (uint32_t i = 0; i <= n; ++i) node[i] = filter(radius * i / n);
    // At a change of sign, the nearer node becomes zero, so that the filter has one sign within each interval.
    for (uint32_t i = 0; i < n; ++i) {
        if (node[i] * node[i + 1] < 0) (std::abs(node[i]) < std::abs(node[i + 1]) ? node[i] : node[i + 1]) = 0;
    }
    double absolute = 0, integral = 0;
    for (uint32_t i = 0; i < n; ++i) {
        absolute += std::abs(node[i] + node[i + 1]);
        integral += node[i] + node[i + 1];
    }
    if (!(integral > 0) || !std::isfinite(absolute))
        throw std::invalid_argument("a pixel filter's integral is not positive");
    const auto add = [&](double value) { distributions.push_back(std::bit_cast<uint32_t>(float(value))); };
    for (const double value : node) add(value / absolute);
    double below = 0;
    std::vector<double> cdf{0.0};
    for (uint32_t i = 0; i < n; ++i) {
        below += std::abs(node[i] + node[i + 1]);
        cdf.push_back(double(float(below / absolute)));
    }
    for (const double value : cdf) add(value);
    add(absolute / integral);
    // The guide: where to start searching for a number between i/n and (i+1)/n. It is at or before the right interval, however
    // i = floor(u n) was rounded.
    for (uint32_t i = 0, cell = 0; i < n; ++i) {
        while (cell + 1 < n && cdf[cell + 1] <= double(i) / n - 1e-6) ++cell;
        add(cell);
    }
}

}  // namespace

double gaussian_filter(double x, double radius, double sigma) {
    const auto gaussian = [sigma](double y) { return std::exp(-y * y / (2 * sigma * sigma)); };
    return std::max(0.0, gaussian(x) - gaussian(radius));
}

double mitchell_filter(double x, double radius, double b, double c) {
    const double y = std::abs(2 * x / radius);
    if (y <= 1) return ((12 - 9 * b - 6 * c) * y * y * y + (-18 + 12 * b + 6 * c) * y * y + (6 - 2 * b)) / 6;
    if (y <= 2)
        return ((-b - 6 * c) * y * y * y + (6 * b + 30 * c) * y * y + (-12 * b - 48 * c) * y + (8 * b + 24 * c)) / 6;
    return 0;
}

double sinc_filter(double x, double radius, double tau) { return std::abs(x) > radius ? 0.0 : sinc(x) * sinc(x / tau); }

uint32_t append_filter_table(const std::function<double(double)>& x_filter, double x_radius,
                             const std::function<double(double)>& y_filter, double y_radius,
                             std::vector<uint32_t>& distributions) {
    const auto offset = uint32_t(distributions.size());
    append_axis(x_filter, x_radius, distributions);
    append_axis(y_filter, y_radius, distributions);
    return offset;
}

}  // namespace lampyris

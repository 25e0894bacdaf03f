// Histograms over a domain that a unit square parametrises, and the counts that a density predicts for their cells.
#pragma once

#include "support/statistics.h"

#include <glm/glm.hpp>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace lampyris::test {

// A domain as seen from the unit square: the density over the square is `jacobian` times the density over the domain.
struct Domain {
    double jacobian;
    std::function<glm::dvec2(glm::vec4)> to_square;
    std::function<glm::vec4(glm::dvec2)> from_square;
};

inline Domain sphere_domain() {
    constexpr double kPi = std::numbers::pi;
    return {4 * kPi,
            [](glm::vec4 p) {
                double phi = std::atan2(double(p.y), double(p.x)) / (2 * kPi);
                return glm::dvec2((double(p.z) + 1) / 2, phi < 0 ? phi + 1 : phi);
            },
            [](glm::dvec2 s) {
                double z = 2 * s.x - 1, r = std::sqrt(std::max(0.0, 1 - z * z));
                return glm::vec4(r * std::cos(2 * kPi * s.y), r * std::sin(2 * kPi * s.y), z, 0);
            }};
}

struct Histogram {
    int nx, ny;
    std::vector<double> cells =
        std::vector<double>(size_t(nx) * ny + 1, 0.0);  // the last: outside, or no sample at all

    void add(const Domain& domain, glm::vec4 p) {
        glm::dvec2 s = domain.to_square(p);
        if (!(s.x >= -1e-6 && s.x <= 1 + 1e-6 && s.y >= -1e-6 && s.y <= 1 + 1e-6)) return miss();
        int x = std::min(int(std::max(s.x, 0.0) * nx), nx - 1), y = std::min(int(std::max(s.y, 0.0) * ny), ny - 1);
        cells[size_t(y) * nx + x] += 1;
    }
    void miss() { cells.back() += 1; }
};

// The counts that `samples` samples of a density should leave in the cells, by midpoint quadrature with sub x sub points per
// cell; if the density integrates to less than 1, the rest are expected to miss. `density` maps all points to their densities
// at once.
inline std::vector<double> expected_counts(
    const Domain& domain, int nx, int ny, int sub, double samples,
    const std::function<std::vector<double>(const std::vector<glm::vec4>&)>& density) {
    std::vector<glm::vec4> points;
    int wide = nx * sub, high = ny * sub;
    points.reserve(size_t(wide) * high);
    for (int y = 0; y < high; ++y)
        for (int x = 0; x < wide; ++x) points.push_back(domain.from_square({(x + 0.5) / wide, (y + 0.5) / high}));
    std::vector<double> values = density(points), cells(size_t(nx) * ny + 1, 0.0);
    double total = 0;
    for (int y = 0; y < high; ++y)
        for (int x = 0; x < wide; ++x) {
            double share = values[size_t(y) * wide + x] * domain.jacobian / (double(wide) * high);
            cells[size_t(y / sub) * nx + x / sub] += share * samples;
            total += share;
        }
    cells.back() = std::max(0.0, 1 - total) * samples;
    return cells;
}

}  // namespace lampyris::test

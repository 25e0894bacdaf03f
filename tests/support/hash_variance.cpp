#include "support/hash_variance.h"

#include "core/photons/photon_map.h"
#include "support/device_run.h"
#include "support/photon_sets.h"

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace lampyris::test {
namespace {

const double kPi = glm::pi<double>();

// Photons of equal flux on the unit square; queries are far from its edge.
PhotonCase make_patch(const VarianceSettings& settings, uint32_t seed) {
    PhotonCase patch;
    patch.radius = float(std::sqrt(settings.lambda / (kPi * settings.photons)));
    patch.low = glm::vec3(0.0f);
    patch.high = glm::vec3(1.0f);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0, 1), inner(0.1f, 0.9f);
    for (uint32_t i = 0; i < settings.photons; ++i) {
        const float x = unit(random), y = unit(random);
        patch.photons.push_back(make_photon({x, y, 0.5f}, {0, 0, -1}, glm::vec3(1.0f), i));
    }
    for (uint32_t i = 0; i < settings.queries; ++i) {
        const float x = inner(random), y = inner(random);
        patch.queries.emplace_back(x, y, 0.5f, patch.radius);
    }
    return patch;
}

std::vector<double> poisson(double mean, size_t count) {
    std::vector<double> p(count);
    for (size_t i = 0; i < count; ++i)
        p[i] = mean > 0 ? std::exp(double(i) * std::log(mean) - mean - std::lgamma(double(i) + 1)) : double(i == 0);
    return p;
}

// Area of the unit disc within a rectangle.
double disc_area(double x0, double x1, double y0, double y1) {
    constexpr int kSteps = 256;
    const double from = std::max(x0, -1.0), to = std::min(x1, 1.0);
    double sum = 0;
    for (int i = 0; i < kSteps && from < to; ++i) {
        const double x = from + (to - from) * (i + 0.5) / kSteps, half = std::sqrt(std::max(0.0, 1 - x * x));
        sum += std::max(0.0, std::min(y1, half) - std::max(y0, -half)) * (to - from) / kSteps;
    }
    return sum;
}

}  // namespace

double kappa(double cell) {
    // E[sum A^2] is the integral over pairs of points of the probability that one cell holds both, (1 - |dx|/c)+ (1 - |dy|/c)+;
    // pairs at distance s have the density of the overlap of two discs.
    constexpr int kSteps = 2000;
    constexpr double kStep = 2.0 / kSteps;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        for (int j = 0; j < kSteps; ++j) {
            const double dx = (i + 0.5) * kStep, dy = (j + 0.5) * kStep, s = std::hypot(dx, dy);
            if (dx >= cell || dy >= cell || s >= 2) break;
            const double overlap = 2 * std::acos(s / 2) - s / 2 * std::sqrt(4 - s * s);
            sum += 4 * overlap * (1 - dx / cell) * (1 - dy / cell) * kStep * kStep;
        }
    }
    return cell * cell / kPi - sum / (kPi * kPi);
}

double expected_excess(double lambda, double cell, double load, uint32_t slots) {
    const double per_area = lambda / kPi, in_cell = per_area * cell * cell;
    // Cells that happen to share the bucket: their number is Poisson, and each contains a Poisson number of photons.
    const double sharing = load / in_cell;
    const auto kCells = size_t(sharing + 12 * std::sqrt(sharing) + 20);
    const std::vector<double> cells = poisson(sharing, kCells);
    const double most = in_cell + load + 12 * std::sqrt(in_cell * (1 + load) + load) + 40;
    const auto kCount = size_t(most);
    constexpr int kOffsets = 12;
    double sum = 0;
    for (int a = 0; a < kOffsets; ++a) {
        for (int b = 0; b < kOffsets; ++b) {
            const double x = -1 - cell * (a + 0.5) / kOffsets, y = -1 - cell * (b + 0.5) / kOffsets;
            for (double x0 = x; x0 < 1; x0 += cell) {
                for (double y0 = y; y0 < 1; y0 += cell) {
                    const double area = disc_area(x0, x0 + cell, y0, y0 + cell);
                    if (area <= 0) continue;
                    std::vector<double> others(kCount, 0.0);
                    for (size_t j = 0; j < kCells; ++j) {
                        if (cells[j] < 1e-12) continue;
                        const auto p = poisson(per_area * (cell * cell - area) + double(j) * in_cell, kCount);
                        for (size_t o = 0; o < kCount; ++o) others[o] += cells[j] * p[o];
                    }
                    const std::vector<double> inside = poisson(per_area * area, kCount);
                    for (size_t m = 1; m < kCount; ++m) {
                        if (inside[m] < 1e-12) continue;
                        for (size_t o = 1; o < kCount; ++o) {
                            const double n = double(m + o);
                            if (n > slots)
                                sum += inside[m] * others[o] * double(m) * double(o) * (n - slots) / (slots * (n - 1));
                        }
                    }
                }
            }
        }
    }
    return sum / (kOffsets * kOffsets) / lambda;
}

Mean measured_excess(Device& device, const VarianceSettings& settings) {
    const auto map = create_photon_map(fmt::format("stochastic_hash:cell_size={},table_size={:.10g},slots={}",
                                                   settings.cell, 1.0 / settings.load, settings.slots));
    const auto exact = create_photon_map("sorted_grid");
    map->open(device);
    exact->open(device);
    Mean excess;
    for (uint32_t s = 0; s < settings.sets; ++s) {
        PhotonSet set = upload_case(device, make_patch(settings, 1000 + s));
        set.seed = s + 1;
        const auto truth = collect(device, *exact, set);
        double squares = 0;
        for (set.pass = 0; set.pass < settings.passes; ++set.pass) {
            const auto found = collect(device, *map, set);
            for (uint32_t q = 0; q < settings.queries; ++q) {
                const double d = double(found[q].sum.w) - double(truth[q].sum.w);
                squares += d * d;
            }
        }
        excess.add(squares / settings.passes / settings.queries / settings.lambda);
    }
    return excess;
}

void expect_excess(Device& device, const VarianceSettings& settings) {
    const double expected = settings.slots == 1
                                ? settings.lambda * kappa(settings.cell) + settings.load
                                : expected_excess(settings.lambda, settings.cell, settings.load, settings.slots);
    const Mean excess = measured_excess(device, settings);
    const std::string text = fmt::format(
        "lambda {}, cell {} r, {} photons a bucket, {} slots: measured {:.4f} +- {:.4f}, expected {:.4f}",
        settings.lambda, settings.cell, settings.load, settings.slots, excess.value(), excess.error(), expected);
    EXPECT_NEAR(excess.value() / expected, 1.0, 0.03) << text;
    EXPECT_LT(excess.error(), 0.01 * expected) << text << ": too noisy to tell";
}

}  // namespace lampyris::test

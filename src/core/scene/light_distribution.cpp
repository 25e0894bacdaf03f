#include "core/scene/light_distribution.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace lampyris {
namespace {

constexpr double kTotal = kernel::CDF_TOTAL;

constexpr double kLeastAboveMean = 1e-3;

double alike(size_t) { return 1; }

// The CDF of weight(0), weight(1), ... into `out` (count + 1 numbers); returns their sum.
template <class Weight>
double fill_cdf(size_t count, const Weight& weight, uint32_t* out) {
    double sum = 0;
    size_t positive = 0;
    for (size_t i = 0; i < count; ++i) {
        sum += weight(i);
        positive += weight(i) > 0;
    }
    if (!(sum > 0)) {
        fill_cdf(count, alike, out);
        return 0;
    }
    // Rounding cannot lose any of these integers: `below` accumulates the same partial sums as `sum` did, and ends exactly at
    // it.
    const double by_weight = kTotal - double(positive);
    double below = 0;
    uint32_t found = 0;
    out[0] = 0;
    for (size_t i = 0; i < count; ++i) {
        below += weight(i);
        found += weight(i) > 0;
        out[i + 1] = uint32_t(below / sum * by_weight) + found;
    }
    return sum;
}

template <class Number>
void check_weights(std::span<const Number> weights) {
    if (weights.empty()) throw std::invalid_argument("a distribution needs weights");
    if (weights.size() > kernel::CDF_TOTAL) throw std::invalid_argument("a distribution of too many weights");
    for (const Number weight : weights) {
        if (!(weight >= 0) || !std::isfinite(weight)) throw std::invalid_argument("a weight is negative or not finite");
    }
}

}  // namespace

uint32_t append_cdf(std::span<const double> weights, std::vector<uint32_t>& distributions) {
    check_weights(weights);
    const size_t offset = distributions.size();
    distributions.resize(offset + weights.size() + 1);
    fill_cdf(
        weights.size(), [&](size_t i) { return weights[i]; }, distributions.data() + offset);
    return uint32_t(offset);
}

uint32_t append_image_distribution(std::span<const float> weights, uint32_t width, uint32_t height, double even,
                                   std::vector<uint32_t>& distributions) {
    check_weights(weights);
    if (weights.size() != size_t(width) * height) throw std::invalid_argument("weights do not match the image's size");
    double sum = 0, positive = 0;
    for (const float weight : weights) {
        sum += weight;
        positive += weight > 0;
    }
    const double share = sum > 0 ? (1.0 - even) / sum : 0.0, base = positive > 0 ? even / positive : 0.0;
    const size_t offset = distributions.size();
    distributions.resize(offset + (height + 1) + size_t(height) * (width + 1));
    std::vector<double> rows(height);
    for (uint32_t y = 0; y < height; ++y) {
        const float* row = weights.data() + size_t(y) * width;
        rows[y] = fill_cdf(
            width, [&](size_t x) { return row[x] > 0 ? share * row[x] + base : 0.0; },
            distributions.data() + offset + (height + 1) + size_t(y) * (width + 1));
    }
    fill_cdf(
        height, [&](size_t y) { return rows[y]; }, distributions.data() + offset);
    return uint32_t(offset);
}

uint32_t append_sky_distributions(std::span<const float> weights, uint32_t width, uint32_t height,
                                  std::vector<uint32_t>& distributions) {
    const uint32_t offset = append_image_distribution(weights, width, height, kEvenLightShare, distributions);
    double sum = 0, above = 0;
    for (const float weight : weights) sum += weight;
    const double mean = sum / double(weights.size());
    std::vector<float> brighter(weights.size());
    for (size_t i = 0; i < weights.size(); ++i) {
        brighter[i] = float(std::max(0.0, weights[i] - mean));
        above += brighter[i];
    }
    // Of a sky that is nearly even, rounding errors would be left.
    const bool compensates = above > kLeastAboveMean * sum;
    append_image_distribution(compensates ? std::span<const float>(brighter) : weights, width, height,
                              compensates ? 0.0 : kEvenLightShare, distributions);
    return offset;
}

void choose_lights(Scene& scene, std::span<const double> powers) {
    scene.record.light_count = uint32_t(scene.lights.size());
    if (scene.lights.empty()) return;
    check_weights(powers);
    if (powers.size() != scene.lights.size()) throw std::invalid_argument("one power a light is wanted");
    double sum = 0;
    for (const double power : powers) sum += power;
    const auto powerful = double(std::count_if(powers.begin(), powers.end(), [](double power) { return power > 0; }));
    std::vector<double> weights(powers.size());
    for (size_t i = 0; i < powers.size(); ++i)
        weights[i] = powers[i] > 0 ? (1.0 - kEvenLightShare) * (powers[i] / sum) + kEvenLightShare / powerful : 0.0;
    const uint32_t offset = append_cdf(weights, scene.distributions);
    scene.record.light_cdf = offset;
    scene.record.light_power = float(std::min(sum, double(std::numeric_limits<float>::max())));
    for (size_t i = 0; i < scene.lights.size(); ++i) {
        const uint32_t share = scene.distributions[offset + i + 1] - scene.distributions[offset + i];
        scene.lights[i].choice_probability = float(share / kTotal);
    }
}

}  // namespace lampyris

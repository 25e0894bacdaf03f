#include "core/scene/light_distribution.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

namespace lampyris {
namespace {

// The CDF of `count` weights into `out` (count + 1 numbers); returns their sum.
double fill_cdf(const float* weights, size_t count, float* out) {
    double sum = 0;
    for (size_t i = 0; i < count; ++i) sum += weights[i];
    double below = 0;
    out[0] = 0.0f;
    for (size_t i = 0; i < count; ++i) {
        below += weights[i];
        const double share = sum > 0 ? below / sum : double(i + 1) / double(count);
        out[i + 1] = std::min(float(share), 1.0f);
    }
    // From the last interval with weight on it is 1 exactly: u < 1 never falls behind it.
    if (sum > 0) {
        for (size_t i = count; i > 0; --i) {
            out[i] = 1.0f;
            if (weights[i - 1] > 0) break;
        }
    }
    out[count] = 1.0f;
    return sum;
}

void check_weights(std::span<const float> weights) {
    if (weights.empty()) throw std::invalid_argument("a distribution needs weights");
    for (const float weight : weights) {
        if (!(weight >= 0) || !std::isfinite(weight)) throw std::invalid_argument("a weight is negative or not finite");
    }
}

}  // namespace

uint32_t append_cdf(std::span<const float> weights, std::vector<float>& distributions) {
    check_weights(weights);
    const size_t offset = distributions.size();
    distributions.resize(offset + weights.size() + 1);
    fill_cdf(weights.data(), weights.size(), distributions.data() + offset);
    return uint32_t(offset);
}

uint32_t append_image_distribution(std::span<const float> weights, uint32_t width, uint32_t height,
                                   std::vector<float>& distributions) {
    check_weights(weights);
    if (weights.size() != size_t(width) * height) throw std::invalid_argument("weights do not match the image's size");
    const size_t offset = distributions.size();
    distributions.resize(offset + (height + 1) + size_t(height) * (width + 1));
    std::vector<double> rows(height);
    for (uint32_t y = 0; y < height; ++y) {
        float* row = distributions.data() + offset + (height + 1) + size_t(y) * (width + 1);
        rows[y] = fill_cdf(weights.data() + size_t(y) * width, width, row);
    }
    // Row sums as floats, scaled so that they cannot overflow.
    const double largest = *std::max_element(rows.begin(), rows.end());
    std::vector<float> row_weights(height);
    for (uint32_t y = 0; y < height; ++y) row_weights[y] = largest > 0 ? float(rows[y] / largest) : 0.0f;
    fill_cdf(row_weights.data(), height, distributions.data() + offset);
    return uint32_t(offset);
}

void choose_lights(Scene& scene, std::span<const float> powers) {
    scene.record.lights.x = uint32_t(scene.lights.size());
    if (scene.lights.empty()) return;
    check_weights(powers);
    if (powers.size() != scene.lights.size()) throw std::invalid_argument("one power a light is wanted");
    double sum = 0;
    for (const float power : powers) sum += power;
    const auto powerful = double(std::count_if(powers.begin(), powers.end(), [](float power) { return power > 0; }));
    std::vector<float> weights(powers.size());
    for (size_t i = 0; i < powers.size(); ++i) {
        weights[i] =
            powers[i] > 0 ? float((1.0 - kEvenLightShare) * powers[i] / sum + kEvenLightShare / powerful) : 0.0f;
    }
    const uint32_t offset = append_cdf(weights, scene.distributions);
    scene.record.lights.z = offset;
    scene.record.lights.w = std::bit_cast<uint32_t>(float(sum));
    for (size_t i = 0; i < scene.lights.size(); ++i) {
        scene.lights[i].emission.w = scene.distributions[offset + i + 1] - scene.distributions[offset + i];
    }
}

}  // namespace lampyris

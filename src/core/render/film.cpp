#include "core/render/film.h"

#include "core/base/error.h"
#include "core/base/memory.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

namespace lampyris {
namespace {

using Estimate = ChannelEstimate;

// A channel's mean and the variance of that mean. With filter importance sampling all weights are equal but for their sign, so
// their average replaces the individual weights.
Estimate estimate(double sum, double squares, double weight_sum, double n) {
    if (n < 1.0 || weight_sum == 0.0) return {0.0, std::numeric_limits<double>::quiet_NaN()};
    const double weight = weight_sum / n;
    const double mean = sum / weight_sum;
    if (n < 2.0) return {mean, std::numeric_limits<double>::quiet_NaN()};
    const double second = squares / (n * weight * weight);
    return {mean, std::max(0.0, second - mean * mean) / (n - 1.0)};
}

std::array<Estimate, 3> estimates(const kernel::FilmPixel& p) {
    const double n = double(p.samples - p.left_out);
    const double weight = double(p.weight) + double(p.weight_low);
    return {estimate(double(p.sum.x) + double(p.low.x), p.squares.x, weight, n),
            estimate(double(p.sum.y) + double(p.low.y), p.squares.y, weight, n),
            estimate(double(p.sum.z) + double(p.low.z), p.squares.z, weight, n)};
}

constexpr double kLargestFloat = std::numeric_limits<float>::max();

// A finite number for an image: NaN, which is an error that is not known yet, becomes 0.
float of_image(double value) {
    return std::isnan(value) ? 0.0f : float(std::clamp(value, -kLargestFloat, kLargestFloat));
}

// The value that |z| of a standard normal variable stays below with the given probability; by bisection on erf.
double normal_quantile(double confidence) {
    double low = 0.0, high = 8.0;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (std::erf(middle / std::numbers::sqrt2) < confidence ? low : high) = middle;
    }
    return low;
}

}  // namespace

Film::Film(Device& device, const Scene& scene, const std::array<int, 4>& crop)
    : window_(crop[0], crop[1], crop[2] - crop[0], crop[3] - crop[1]),
      full_width_(scene.width()),
      full_height_(scene.height()) {
    // The film's copy on the device, the one here, and the image with its channels (14 floats a pixel).
    require_memory(2 * sizeof(kernel::FilmPixel) + 14 * sizeof(float));
    buffer_ = device.create_buffer(size_t(pixel_count()) * sizeof(kernel::FilmPixel), "the film");
    buffer_->fill_zero();
    pixels_.resize(pixel_count());
}

void Film::require_memory(size_t bytes_per_pixel) const {
    const uint64_t needed = uint64_t(pixel_count()) * bytes_per_pixel;
    if (needed <= machine_memory()) return;
    throw MachineError(
        fmt::format("error: a film of {}x{} pixels needs {:.1f} GB, and this machine has {:.1f} GB of memory; "
                    "render a part of it (--crop), or at a smaller --resolution",
                    window_.z, window_.w, double(needed) * 1e-9, double(machine_memory()) * 1e-9));
}

void Film::attach_bias(BufferHandle buffer, double confidence) {
    // Its copies, and six more channels.
    require_memory(2 * (sizeof(kernel::FilmPixel) + sizeof(kernel::FilmBias)) + 20 * sizeof(float));
    bias_buffer_ = std::move(buffer);
    biases_.assign(pixels_.size(), kernel::FilmBias{});
    confidence_ = confidence;
}

void Film::restore(const std::vector<kernel::FilmPixel>& pixels) {
    if (pixels.size() != pixel_count())
        throw InputError(
            fmt::format("error: the checkpoint has {} pixels, the picture {}", pixels.size(), pixel_count()));
    buffer_->upload(pixels.data(), pixels.size() * sizeof(kernel::FilmPixel));
}

void Film::download() {
    buffer_->download(pixels_.data(), pixels_.size() * sizeof(kernel::FilmPixel));
    if (bias_buffer_) bias_buffer_->download(biases_.data(), biases_.size() * sizeof(kernel::FilmBias));
}

FilmSummary Film::summary() const {
    FilmSummary result;
    result.min_samples = std::numeric_limits<uint32_t>::max();
    for (size_t i = 0; i < pixels_.size(); ++i) {
        const kernel::FilmPixel& p = pixels_[i];
        result.samples += p.samples;
        result.rays += p.rays;
        result.min_samples = std::min(result.min_samples, p.samples);
        result.max_samples = std::max(result.max_samples, p.samples);
        if (p.left_out > 0 && result.non_finite == 0)
            result.first_non_finite = {uint32_t(window_.x + i % window_.z), uint32_t(window_.y + i / window_.z),
                                       p.first_left_out};
        result.non_finite += p.left_out;
    }
    const ErrorEstimate error = estimate_error(
        window_.z, window_.w, [&](uint32_t x, uint32_t y) { return pixel_estimate(size_t(y) * window_.z + x); });
    result.unknown_errors = error.unknown;
    result.estimated_relmse = error.relmse;
    result.health = {result.min_samples, error.largest_share, error.dark_share};
    return result;
}

PixelEstimate Film::pixel_estimate(size_t i) const {
    const kernel::FilmPixel& p = pixels_[i];
    PixelEstimate result;
    result.radiance = estimates(p);
    result.sees_surface = p.albedo.x > 0.0f || p.albedo.y > 0.0f || p.albedo.z > 0.0f;
    result.has_light = p.squares.x > 0.0f || p.squares.y > 0.0f || p.squares.z > 0.0f;
    result.left_out = p.samples >= 2 && p.samples == p.left_out;
    for (const Estimate& e : result.radiance) {
        result.left_out |= !std::isfinite(e.mean);
        result.unknown |= e.variance > kLargestFloat;
    }
    if (!bias_buffer_ || result.left_out) return result;
    const std::array<Estimate, 3> bias = bias_estimates(i);
    for (const Estimate& e : bias) result.unknown |= !std::isfinite(e.mean) || e.variance > kLargestFloat;
    // The square of a noisy estimate is too large by its variance, on average; the corrected value may be negative in some
    // pixels.
    for (size_t c = 0; c < 3; ++c) result.bias_squared[c] = bias[c].mean * bias[c].mean - bias[c].variance;
    return result;
}

std::array<ChannelEstimate, 3> Film::bias_estimates(size_t i) const {
    const kernel::FilmPixel& p = pixels_[i];
    const double n = double(p.samples - p.left_out), weight = double(p.weight) + double(p.weight_low);
    std::array<Estimate, 3> result;
    for (int c = 0; c < 3; ++c)
        result[size_t(c)] = estimate(double(biases_[i].sum[c]), double(biases_[i].squares[c]), weight, n);
    return result;
}

std::vector<float> Film::rgb() const {
    std::vector<float> result;
    result.reserve(pixels_.size() * 3);
    for (const kernel::FilmPixel& p : pixels_)
        for (const Estimate& e : estimates(p)) result.push_back(float(e.mean));
    return result;
}

Image Film::image() const {
    std::vector<std::string> channels{"R",          "G",          "B",          "albedo.R", "albedo.G",
                                      "albedo.B",   "normal.X",   "normal.Y",   "normal.Z", "depth.Z",
                                      "variance.R", "variance.G", "variance.B", "samples"};
    if (bias_buffer_) channels.insert(channels.end(), {"bias.R", "bias.G", "bias.B", "error.R", "error.G", "error.B"});
    const double z = normal_quantile(confidence_);
    Image image(int(window_.z), int(window_.w), std::move(channels));
    image.x = int(window_.x);
    image.y = int(window_.y);
    image.full_width = int(full_width_);
    image.full_height = int(full_height_);
    float* out = image.pixels.data();
    for (size_t i = 0; i < pixels_.size(); ++i) {
        const kernel::FilmPixel& p = pixels_[i];
        const std::array<Estimate, 3> e = estimates(p);
        for (int c = 0; c < 3; ++c) *out++ = float(e[size_t(c)].mean);
        const float hits = p.hits;
        const float to_hits = hits > 0.0f ? 1.0f / hits : 0.0f;
        for (int c = 0; c < 3; ++c) *out++ = p.albedo[c] * to_hits;
        const glm::vec3 n(p.normal);
        const float length = glm::length(n);
        for (int c = 0; c < 3; ++c) *out++ = length > 0.0f ? n[c] / length : 0.0f;
        *out++ = p.depth * to_hits;
        for (int c = 0; c < 3; ++c) *out++ = of_image(e[size_t(c)].variance);
        *out++ = float(p.samples);
        if (!bias_buffer_) continue;
        const std::array<Estimate, 3> bias = bias_estimates(i);
        for (size_t c = 0; c < 3; ++c) *out++ = of_image(bias[c].mean);
        for (size_t c = 0; c < 3; ++c) {
            // The true error differs from the estimated bias by the noise of the image and that of the bias.
            const double variance = e[c].variance + bias[c].variance;
            const double noise = std::isnan(variance) ? 0.0 : std::sqrt(variance);
            *out++ = of_image(std::abs(bias[c].mean) + z * noise);
        }
    }
    return image;
}

}  // namespace lampyris

#include "core/image/metrics.h"

#include "core/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace lampyris {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

bool finite_pixel(const float* image, const float* reference) {
    for (int c = 0; c < 3; ++c)
        if (!std::isfinite(image[c]) || !std::isfinite(reference[c])) return false;
    return true;
}

}  // namespace

const std::vector<MetricFormula>& metric_formulas() {
    static const std::vector<MetricFormula> list = {
        {"mse", "MSE", "mean (I-R)^2", &Metrics::mse},
        {"rmse", "RMSE", "sqrt MSE", &Metrics::rmse},
        {"relmse", "relMSE", "mean (I-R)^2 / (R^2 + 0.01)", &Metrics::relmse},
        {"relmse_trimmed", "relMSE, trimmed", "relMSE without the 0.1 % of pixels where it is largest",
         &Metrics::relmse_trimmed},
        {"mape", "MAPE", "mean |I-R| / (|R| + 0.01)", &Metrics::mape},
        {"smape", "SMAPE", "mean 2 |I-R| / (|I| + |R| + 0.01)", &Metrics::smape},
    };
    return list;
}

Metrics measure(std::span<const float> image, std::span<const float> reference) {
    if (image.size() != reference.size() || image.size() % 3 != 0)
        throw InputError(
            fmt::format("{} and {} numbers are no two RGB images of one size", image.size(), reference.size()));
    const size_t count = image.size() / 3;
    Metrics metrics;
    std::vector<double> relative;  // per pixel, mean over its channels
    relative.reserve(count);
    double squares = 0.0, absolute = 0.0, symmetric = 0.0;
    for (size_t i = 0; i < count; ++i) {
        if (!finite_pixel(&image[3 * i], &reference[3 * i])) {
            ++metrics.non_finite;
            continue;
        }
        double relative_squares = 0.0;
        for (size_t c = 0; c < 3; ++c) {
            const double a = image[3 * i + c], r = reference[3 * i + c], d = a - r;
            metrics.mean[c] += a;
            metrics.reference_mean[c] += r;
            squares += d * d;
            relative_squares += d * d / (r * r + 0.01);
            // Light is not negative, but pixel filters with negative lobes can make it so; |R| keeps the denominator positive.
            absolute += std::fabs(d) / (std::fabs(r) + 0.01);
            symmetric += 2.0 * std::fabs(d) / (std::fabs(a) + std::fabs(r) + 0.01);
        }
        relative.push_back(relative_squares / 3.0);
    }
    metrics.pixels = relative.size();
    const double pixels = double(metrics.pixels);  // 0 / 0 is NaN, as documented
    for (size_t c = 0; c < 3; ++c) {
        metrics.mean[c] /= pixels;
        metrics.reference_mean[c] /= pixels;
    }
    metrics.mse = squares / (3.0 * pixels);
    metrics.rmse = std::sqrt(metrics.mse);
    metrics.mape = absolute / (3.0 * pixels);
    metrics.smape = symmetric / (3.0 * pixels);
    double sum = 0.0;
    for (const double value : relative) sum += value;
    metrics.relmse = sum / pixels;

    const size_t trimmed = size_t(std::floor(pixels * kTrimmedShare));
    if (trimmed > 0) {
        std::nth_element(relative.begin(), relative.begin() + std::ptrdiff_t(trimmed), relative.end(),
                         std::greater<>());
        // Summed again: subtracting a firefly of 1e30 would cancel everything else.
        sum = 0.0;
        for (size_t i = trimmed; i < relative.size(); ++i) sum += relative[i];
    }
    metrics.relmse_trimmed = sum / (pixels - double(trimmed));
    return metrics;
}

void check_same_size(const Image& image, const Image& reference) {
    if (image.width != reference.width || image.height != reference.height)
        throw InputError(
            fmt::format("the image has {} pixels, but the reference has {}", image.size_text(), reference.size_text()));
}

Metrics measure(const Image& image, const Image& reference) {
    check_same_size(image, reference);
    return measure(image.rgb().pixels, reference.rgb().pixels);
}

Comparison compare_images(const Image& image, const Image& reference) {
    check_same_size(image, reference);
    Image shown = image.rgb(), wanted = reference.rgb();
    make_linear(shown);
    make_linear(wanted);
    Comparison comparison;
    comparison.width = image.width;
    comparison.height = image.height;
    comparison.metrics = measure(shown.pixels, wanted.pixels);
    const auto is_float = [](const Image& i) {
        return i.storage == Image::Storage::kFloat || i.storage == Image::Storage::kHalf;
    };
    comparison.hdr = is_float(image) && is_float(reference);

    // FLIP looks at neighbourhoods, so left-out pixels need some value: they get the same one in both images.
    std::vector<size_t> left_out;
    for (size_t i = 0; i < shown.pixel_count(); ++i) {
        float *a = &shown.pixels[3 * i], *r = &wanted.pixels[3 * i];
        if (finite_pixel(a, r)) continue;
        left_out.push_back(i);
        for (int c = 0; c < 3; ++c) a[c] = r[c] = std::isfinite(r[c]) ? r[c] : 0.0f;
    }
    comparison.flip = comparison.hdr ? flip_hdr(shown, wanted) : flip_ldr(shown, wanted);
    for (const size_t i : left_out) comparison.flip.error[i] = std::numeric_limits<float>::quiet_NaN();
    double sum = 0.0;
    for (const float error : comparison.flip.error)
        if (!std::isnan(error)) sum += error;
    comparison.flip.mean = comparison.metrics.pixels > 0 ? sum / double(comparison.metrics.pixels) : kNotANumber;
    return comparison;
}

std::vector<uint8_t> error_picture(const Comparison& comparison) {
    std::vector<uint8_t> bytes;
    bytes.reserve(3 * comparison.flip.error.size());
    for (const float error : comparison.flip.error) {
        const std::array<uint8_t, 3> color = std::isnan(error) ? std::array<uint8_t, 3>{0, 255, 0} : magma(error);
        bytes.insert(bytes.end(), color.begin(), color.end());
    }
    return bytes;
}

}  // namespace lampyris

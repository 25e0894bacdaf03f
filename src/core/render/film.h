// The film: the sums of each pixel's samples on the device, and the image, error estimate and features made of them.
#pragma once

#include "core/device/device.h"
#include "core/device/kernel_types.h"
#include "core/image/image.h"
#include "core/render/error_estimate.h"
#include "core/render/forecast.h"
#include "core/scene/scene.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace lampyris {

struct FilmSummary {
    uint64_t samples = 0, rays = 0;
    uint32_t min_samples = 0, max_samples = 0;   // of a pixel
    uint64_t non_finite = 0;                     // samples left out: not finite, or too large for the sums
    std::array<uint32_t, 3> first_non_finite{};  // x, y, pass; meaningful where non_finite > 0
    uint64_t unknown_errors = 0;                 // pixels whose variance or bias is beyond the range of a float
    // Estimated relMSE: the mean over pixels and channels of (Var(mean) + bias^2) / (R^2 + 0.01), with R estimated by
    // core/render/error_estimate.h. Samples are taken as independent, which overstates the error of a stratified sampler. The bias is
    // that of attach_bias, else 0. NaN if pixels have fewer than two samples, or if there are unknown_errors.
    double estimated_relmse = 0.0;
    EstimateHealth health;  // whether the estimate can be trusted
};

class Film {
 public:
    // Renders the pixels of `crop` (x0, y0, x1, y1, half-open, in the full picture).
    Film(Device& device, const Scene& scene, const std::array<int, 4>& crop);

    const BufferHandle& buffer() const { return buffer_; }  // FilmPixel, row by row
    glm::uvec4 window() const { return window_; }           // x0, y0, width, height
    uint32_t pixel_count() const { return window_.z * window_.w; }

    // For integrators that estimate their bias sample by sample: kernel::FilmBias, pixel by pixel. From then on the bias is
    // part of the summary's error, and the image has the channels `bias` (of the mean) and `error`: |bias| + z sqrt(variance of
    // both). The true error stays below this with the given confidence where radiance is smooth (Hachisuka et al. 2010,
    // equation 17).
    void attach_bias(BufferHandle buffer, double confidence);

    // The sums of an earlier rendering, in place of none. Throws InputError if these are other pixels.
    void restore(const std::vector<kernel::FilmPixel>& pixels);
    void download();  // copies the sums from the device; the functions below use the last download
    FilmSummary summary() const;
    std::vector<float> rgb() const;  // [height][width][3]
    // R, G, B and the features albedo, normal, depth, variance (of the mean), samples. Values beyond the range of a float are
    // clamped to it.
    Image image() const;
    const std::vector<kernel::FilmPixel>& pixels() const { return pixels_; }
    std::vector<kernel::FilmPixel> take_pixels() { return std::move(pixels_); }  // the last call

 private:
    void require_memory(size_t bytes_per_pixel) const;  // throws MachineError
    std::array<ChannelEstimate, 3> bias_estimates(size_t pixel) const;
    PixelEstimate pixel_estimate(size_t pixel) const;
    glm::uvec4 window_;
    uint32_t full_width_, full_height_;
    BufferHandle buffer_;
    std::vector<kernel::FilmPixel> pixels_;
    BufferHandle bias_buffer_;
    std::vector<kernel::FilmBias> biases_;
    double confidence_ = 0.0;
};

}  // namespace lampyris

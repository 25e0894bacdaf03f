// The image that a film makes of a pixel's sums, against the statistics of samples that are written out here.
#include "core/render/film.h"

#include "core/device/device.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

namespace lampyris {
namespace {

using Samples = std::array<double, 4>;

double mean(const Samples& samples) {
    double sum = 0.0;
    for (const double x : samples) sum += x;
    return sum / double(samples.size());
}

// Of the mean.
double variance(const Samples& samples) {
    double squares = 0.0;
    for (const double x : samples) squares += (x - mean(samples)) * (x - mean(samples));
    return squares / double(samples.size() - 1) / double(samples.size());
}

double squares(const Samples& samples) {
    double sum = 0.0;
    for (const double x : samples) sum += x * x;
    return sum;
}

// Of each channel: radiance is noisy in green and blue, the bias in red and blue.
constexpr std::array<Samples, 3> kRadiance{Samples{3, 3, 3, 3}, Samples{1, 2, 3, 6}, Samples{0.5, 0.25, 0.75, 1}};
constexpr std::array<Samples, 3> kBias{Samples{0.5, -0.125, 0.25, 0.125}, Samples{-0.25, -0.25, -0.25, -0.25},
                                       Samples{0.25, 0.5, 0, 0.25}};

class FilmOfOnePixel : public testing::Test {
 protected:
    FilmOfOnePixel() : device_(create_device("cpu")) {
        scene_.record.camera.resolution_x = scene_.record.camera.resolution_y = 1;
        film_.emplace(*device_, scene_, std::array<int, 4>{0, 0, 1, 1});
        kernel::FilmPixel pixel{};
        for (int c = 0; c < 3; ++c) {
            pixel.sum[c] = float(4.0 * mean(kRadiance[size_t(c)]));
            pixel.squares[c] = float(squares(kRadiance[size_t(c)]));
        }
        pixel.weight = 4.0f;
        pixel.samples = 4;
        pixel.hits = 2.0f;  // the others saw the sky
        pixel.depth = 7.0f;
        pixel.albedo = kernel::vec3(1.0f, 0.5f, 0.25f);
        pixel.normal = kernel::vec3(0.0f, 0.6f, 1.6f);
        film_->restore({pixel});
    }
    void attach_bias(double confidence) {
        kernel::FilmBias bias{};
        for (int c = 0; c < 3; ++c) {
            bias.sum[c] = float(4.0 * mean(kBias[size_t(c)]));
            bias.squares[c] = float(squares(kBias[size_t(c)]));
        }
        const BufferHandle buffer = device_->create_buffer(sizeof bias, "bias");
        buffer->upload(&bias, sizeof bias);
        film_->attach_bias(buffer, confidence);
    }
    double channel(const Image& image, const std::string& name) const {
        const int found = image.find_channel(name);
        EXPECT_GE(found, 0) << name;
        return double(image.pixels.at(size_t(found)));
    }

    std::unique_ptr<Device> device_;
    Scene scene_;
    std::optional<Film> film_;
};

const std::array<std::string, 3> kNames{"R", "G", "B"};

TEST_F(FilmOfOnePixel, ShowsTheMeanAndItsVariance) {
    film_->download();
    const Image image = film_->image();
    for (size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(channel(image, kNames[c]), mean(kRadiance[c]), 1e-6);
        EXPECT_NEAR(channel(image, "variance." + kNames[c]), variance(kRadiance[c]), 1e-6);
    }
}

TEST_F(FilmOfOnePixel, ShowsTheFeaturesOfHitsAlone) {
    film_->download();
    const Image image = film_->image();
    EXPECT_FLOAT_EQ(float(channel(image, "depth.Z")), 3.5f);
    EXPECT_FLOAT_EQ(float(channel(image, "albedo.R")), 0.5f);
    EXPECT_FLOAT_EQ(float(channel(image, "albedo.B")), 0.125f);
    EXPECT_FLOAT_EQ(float(channel(image, "normal.Z")), 1.6f / std::sqrt(0.36f + 2.56f));
}

// |bias| + z sqrt(variance of both), with the 95 % quantile z of |normal|.
TEST_F(FilmOfOnePixel, BoundsTheErrorByBiasAndNoiseOfBoth) {
    attach_bias(0.95);
    film_->download();
    const Image image = film_->image();
    for (size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(channel(image, "bias." + kNames[c]), mean(kBias[c]), 1e-6);
        EXPECT_NEAR(channel(image, "error." + kNames[c]),
                    std::abs(mean(kBias[c])) + 1.959964 * std::sqrt(variance(kRadiance[c]) + variance(kBias[c])), 1e-5);
    }
}

// The pixel has no neighbours, so R is its own mean. The square of a bias's mean is too large by the mean's variance.
TEST_F(FilmOfOnePixel, EstimatesRelmse) {
    attach_bias(0.95);
    film_->download();
    double expected = 0.0;
    for (size_t c = 0; c < 3; ++c) {
        const double bias = mean(kBias[c]), r = mean(kRadiance[c]);
        expected += (variance(kRadiance[c]) + bias * bias - variance(kBias[c])) / (r * r + 0.01) / 3.0;
    }
    EXPECT_NEAR(film_->summary().estimated_relmse, expected, 1e-6);
}

}  // namespace
}  // namespace lampyris

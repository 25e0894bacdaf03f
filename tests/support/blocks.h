// Images of two unbiased methods, compared block by block.
#pragma once

#include "support/runs.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace lampyris::test {

// |t| that Student's distribution with `dof` degrees of freedom exceeds with probability p (two-sided), from the normal threshold
// (Abramowitz and Stegun, 26.7.5).
inline double student_threshold(double p, double dof) {
    const double z = normal_threshold(p), z2 = z * z;
    return z * (1 + (z2 + 1) / (4 * dof) + (5 * z2 * z2 + 16 * z2 + 3) / (96 * dof * dof) +
                (3 * z2 * z2 * z2 + 19 * z2 * z2 + 17 * z2 - 15) / (384 * dof * dof * dof));
}

// A block's mean and the variance of that mean. Pixels are taken as independent: light paths add to a pixel as a Poisson process
// does, and to its neighbours by other vertices.
struct Block {
    double mean = 0, variance = 0;
    double error() const { return std::sqrt(variance); }
};
inline Block block(const Rendered& image, int x0, int y0, int x1, int y1) {
    Block b;
    const double count = double(x1 - x0) * (y1 - y0);
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x)
            b.mean += image.luminance(x, y) / count, b.variance += image.luminance_variance(x, y) / (count * count);
    return b;
}
inline Block whole(const Rendered& image) { return block(image, 0, 0, image.width, image.height); }

// Compares blocks of size x size pixels and the whole images. False alarms: kAlpha in all, by Sidak's correction. `bias`: allowed in
// addition, relative to a block's mean.
inline void expect_same_blocks(const Rendered& image, const Rendered& expected, int size, const std::string& name,
                               double bias = 0.0) {
    ASSERT_EQ(image.width, expected.width);
    ASSERT_EQ(image.height, expected.height);
    const int columns = (image.width + size - 1) / size, rows = (image.height + size - 1) / size;
    const double threshold = normal_threshold(kAlpha / (columns * rows + 1));
    bool differs = false;
    const auto compare = [&](const Block& a, const Block& b, const std::string& where) {
        // 1e-6: pixels without variance, such as those of an empty background.
        const double error = std::sqrt(a.variance + b.variance) + 1e-6;
        const bool same = std::abs(a.mean - b.mean) < threshold * error + bias * b.mean;
        EXPECT_TRUE(same) << where << ": " << a.mean << ", expected " << b.mean << ", standard error " << error;
        differs = differs || !same;
    };
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const int x1 = std::min((i + 1) * size, image.width), y1 = std::min((j + 1) * size, image.height);
            compare(block(image, i * size, j * size, x1, y1), block(expected, i * size, j * size, x1, y1),
                    fmt::format("{}, block {} {}", name, i, j));
        }
    compare(whole(image), whole(expected), name);
    if (differs) {
        save_failure(name_of(name), image.image);
        save_failure(name_of(name) + "_expected", expected.image);
    }
}

}  // namespace lampyris::test

// Tables by which kernels choose lights and sample images of light; their layout is in core/kernel/layout.h.
#pragma once

#include "core/scene/scene.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lampyris {

// Appends the CDF of a distribution in proportion to `weights` (not negative; all zero means all alike): weights.size() + 1
// integers that do not decrease, from 0 to kernel::CDF_TOTAL. Returns the offset of the first. The probability of i is exactly the
// difference of numbers i + 1 and i over CDF_TOTAL, which is what kernels use. It is at least 1 for a positive weight, however small
// its share: one number each goes to the positive weights, the rest to all by their weight.
// Throws std::invalid_argument for no weights, more than CDF_TOTAL, or one that is negative or not finite.
uint32_t append_cdf(std::span<const double> weights, std::vector<uint32_t>& distributions);

// Appends a piecewise constant distribution over an image's texels (row by row from the top) and returns its offset.
// `weights` are values times the solid angle of a texel; in equal-area maps all solid angles are equal, so the values alone
// (say, luminance) will do. The share `even` of samples is spread evenly over the texels that have any weight.
uint32_t append_image_distribution(std::span<const float> weights, uint32_t width, uint32_t height, double even,
                                   std::vector<uint32_t>& distributions);

// The share of samples that is spread evenly over all lights that have any power, and over all texels of a sky that are not black: one
// that is weak on the whole may be all there is in a corner.
inline constexpr double kEvenLightShare = 0.05;

// Gives each of scene.lights its probability of being chosen (LightRecord::emission.w), for the rest in proportion to
// `powers` (luminous, W; one a light; zero: never chosen), and the scene the table that kernels choose by.
void choose_lights(Scene& scene, std::span<const double> powers);

}  // namespace lampyris

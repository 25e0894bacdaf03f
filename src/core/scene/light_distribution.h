// Tables by which kernels choose lights and sample images of light; their layout is in core/kernel/layout.h.
#pragma once

#include "core/scene/scene.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lampyris {

// Appends the CDF of a distribution in proportion to `weights` (not negative; all zero means all alike): weights.size() + 1
// numbers that do not decrease, from 0 to 1 exactly. Returns the offset of the first. The probability of i is, to the bit,
// the difference of numbers i + 1 and i, which is what kernels use; weights below 2^-25 of the sum may get none.
// Throws std::invalid_argument for no weights, or one that is negative or not finite.
uint32_t append_cdf(std::span<const float> weights, std::vector<float>& distributions);

// Appends a piecewise constant distribution over an image's texels (row by row from the top) and returns its offset.
// `weights` are values times the solid angle of a texel; in equal-area maps all solid angles are equal, so the values alone
// (say, luminance) will do.
uint32_t append_image_distribution(std::span<const float> weights, uint32_t width, uint32_t height,
                                   std::vector<float>& distributions);

// The share of samples that is spread evenly over all lights that have any power: a light that is weak on the whole may be
// all there is in a corner.
inline constexpr float kEvenLightShare = 0.05f;

// Gives each of scene.lights its probability of being chosen (LightRecord::emission.w), for the rest in proportion to
// `powers` (luminous, W; one a light; zero: never chosen), and the scene the table that kernels choose by.
void choose_lights(Scene& scene, std::span<const float> powers);

}  // namespace lampyris

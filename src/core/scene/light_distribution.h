// Tables by which kernels choose lights and sample images of light; their layout is in core/kernel/layout.h.
#pragma once

#include "core/scene/scene.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lampyris {

// Appends the CDF of a distribution in proportion to `weights` (not negative; all zero means uniform): weights.size() + 1
// integers that do not decrease, from 0 to kernel::CDF_TOTAL. Returns the offset of the first. The probability of i is exactly
// the difference of entries i + 1 and i, divided by CDF_TOTAL; kernels use this value. Every positive weight, however small,
// gets a difference of at least 1; the rest of CDF_TOTAL is shared in proportion to the weights.
// Throws std::invalid_argument for no weights, more than CDF_TOTAL, or one that is negative or not finite.
uint32_t append_cdf(std::span<const double> weights, std::vector<uint32_t>& distributions);

// Appends a piecewise constant distribution over an image's texels (row by row from the top) and returns its offset.
// `weights` are values times the solid angle of a texel. In equal-area maps all solid angles are equal, so the values alone
// (say, luminance) suffice. The fraction `even` of samples is spread evenly over the texels with a positive weight.
uint32_t append_image_distribution(std::span<const float> weights, uint32_t width, uint32_t height, double even,
                                   std::vector<uint32_t>& distributions);

// Appends the two distributions of an infinite light's image, one behind the other, and returns the first one's offset: in
// proportion to `weights`, with kEvenLightShare; and to what they have above their mean, for samples that are weighed against
// those of a BSDF (core/kernel/environment.h). The second one is the first if hardly anything is above the mean.
uint32_t append_sky_distributions(std::span<const float> weights, uint32_t width, uint32_t height,
                                  std::vector<uint32_t>& distributions);

// The fraction of samples that is spread evenly over all lights with a positive power, and over all texels of a sky that are
// not black: a light that is weak on the whole may be the only one that reaches some corner.
inline constexpr double kEvenLightShare = 0.05;

// Sets the probability of choosing each of scene.lights (LightRecord::choice_probability) and appends the table that kernels choose by.
// Apart from the even share, the probability is in proportion to `powers` (luminous, W; one per light; zero: never chosen).
void choose_lights(Scene& scene, std::span<const double> powers);

}  // namespace lampyris

// FLIP: how different two images look to a person who flips between them on the same screen; 0 (identical) to 1 per pixel.
//
// LDR-FLIP: Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", HPG 2020. HDR-FLIP: Andersson et
// al., "Visualizing Errors in Rendered High Dynamic Range Images", Eurographics Short Papers 2021: the largest LDR-FLIP
// over a range of exposures that follows from the reference. Written from the papers; agrees with the authors'
// flip-evaluator (tests/unit/flip_test.cpp).
#pragma once

#include "core/image/image.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lampyris {

// 0.7 m away from a screen 0.7 m and 3840 pixels wide, as in the papers.
inline constexpr double kFlipPixelsPerDegree = 3840.0 * 3.14159265358979323846 / 180.0;

struct FlipResult {
    std::vector<float> error;  // [height][width], 0 to 1
    double mean = 0.0;
    // HDR-FLIP only, in stops.
    double start_exposure = 0.0, stop_exposure = 0.0;
    int exposures = 0;
};

// Both take scene-linear R, G, B images of one size (Image::rgb), without NaN and Inf.
// LDR: light is cut to [0, 1], as a display does.
FlipResult flip_ldr(const Image& image, const Image& reference, double pixels_per_degree = kFlipPixelsPerDegree);
// HDR: tone-mapped with ACES' curve (Narkowicz's fit, as in the paper) at each exposure; negative light counts as zero.
FlipResult flip_hdr(const Image& image, const Image& reference, double pixels_per_degree = kFlipPixelsPerDegree);

// The papers' colours for an error from 0 to 1: the magma map (Smith and van der Walt, CC0), sRGB.
std::array<uint8_t, 3> magma(float error);

}  // namespace lampyris

// Limits that a scene file and the command line share.
#pragma once

namespace lampyris {

constexpr int kLargestSide = 1 << 15;  // of a picture, in pixels
constexpr int kMostSamples = 1 << 30;  // of a pixel, and passes

}  // namespace lampyris

// Limits that a scene file and the command line share.
#pragma once

#include <cstddef>

namespace lampyris {

constexpr int kLargestSide = 1 << 15;  // of a picture, in pixels
constexpr int kMostSamples = 1 << 30;  // of a pixel, and passes
// Different parameters that Attribute directives may set for entities of one kind: each entity looks through them.
constexpr size_t kMostDefaults = 256;

}  // namespace lampyris

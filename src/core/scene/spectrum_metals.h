// Tables of metals; internal to the named spectra.
#pragma once

#include <array>
#include <span>

namespace lampyris {

inline constexpr float kMetalFirst = 360.0f, kMetalStep = 10.0f;  // nm
struct Metal {
    const char* name;
    std::array<float, 48> n, k;
};
std::span<const Metal> metals();

}  // namespace lampyris

// Linear RGB spaces by their primaries and white point.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace lampyris {

// CIE 1931 x, y chromaticities.
struct Primaries {
    glm::dvec2 red, green, blue, white;
};

inline constexpr glm::dvec2 kD65{0.3127, 0.3290};
inline constexpr Primaries kRec709{{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, kD65};

// XYZ of a chromaticity, with Y = 1.
glm::dvec3 xyz_of(glm::dvec2 xy);

// From linear RGB to XYZ, with the white's Y = 1 (SMPTE RP 177-1993).
glm::dmat3 xyz_from_rgb(const Primaries& primaries);

// From linear RGB with these primaries to linear Rec.709. White points are not adapted: the light's chromaticity is kept.
glm::dmat3 rec709_from_rgb(const Primaries& primaries);

}  // namespace lampyris

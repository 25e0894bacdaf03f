// Where lights are and into which directions they emit, for the tree of lights.
#pragma once

#include "core/scene/scene.h"

#include <glm/vec3.hpp>

#include <limits>

namespace lampyris {

// Bounds of one light or of several. Emission leaves at an angle of at most `emission` to a normal, and normals are at an angle
// of at most `normals` to the axis.
struct LightBounds {
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    glm::dvec3 axis{0, 0, 1};
    double normals = 0, emission = 0;
    bool two_sided = false;  // around the negated axis as well
    double intensity = 0;    // along a normal, W/sr, luminous

    void add(const glm::dvec3& p);
    glm::dvec3 middle() const { return 0.5 * (low + high); }
};

LightBounds joined(const LightBounds& a, const LightBounds& b);

// The cost of a node, in proportion to the chance that it is looked into and to how little it tells about its lights: intensity,
// the measure of its directions, and its size (Conty Estevez and Kulla 2018, section 4.4). The surface area of a box is 0 for
// lights in a line; the squared diagonal is not.
double tree_cost(const LightBounds& bounds);

// Of a light that has a place, and the luminous power `power` (W).
LightBounds light_bounds(const Scene& scene, const kernel::LightRecord& light, double power);

}  // namespace lampyris

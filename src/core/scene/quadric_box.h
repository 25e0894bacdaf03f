// Boxes of spheres, disks and cylinders.
#pragma once

#include "core/scene/scene.h"

#include <glm/vec3.hpp>

#include <array>

namespace lampyris {

// The corners of the box around a quadric in its own space, in the space of its set. Angles and inner radii are not looked at.
std::array<glm::dvec3, 8> quadric_corners(const Scene& scene, const kernel::GeometryRecord& geometry);

}  // namespace lampyris

// How far off a triangle's plane ray tracers may find its points: the host's side of triangle_plane_error (core/kernel/shapes.h).
#pragma once

#include "core/scene/shapes/mesh.h"

#include <glm/glm.hpp>

namespace lampyris {

constexpr double kHalfUlp = 0x1p-24;  // of 1: eps, as MACHINE_EPSILON (core/kernel/math.h)

// Anywhere on the triangle that has these edges from its first corner.
double triangle_plane_error(const glm::dvec3& e1, const glm::dvec3& e2);

// Of any triangle of the mesh; -1 where that would be seen beside the smallest one, and each point needs its own.
float mesh_plane_error(const Mesh& mesh);

}  // namespace lampyris

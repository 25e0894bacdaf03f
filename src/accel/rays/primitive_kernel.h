// Quadrics and bilinear patches for ray tracers written in C++: the kernels' own intersection code, behind plain functions.
#pragma once

#include <glm/vec3.hpp>

#include <cstdint>

namespace lampyris {

struct Scene;

struct PrimitiveBounds {
    glm::vec3 low, high;
};

// Bounds of a quadric or patch in its geometry set's space.
PrimitiveBounds primitive_bounds(const Scene& scene, uint32_t geometry, uint32_t primitive);

// Closest hit with 0 < t < t_max; ray in the geometry set's space.
bool primitive_hit(void* const* scene_buffers, uint32_t geometry, uint32_t primitive, const float origin[3],
                   const float direction[3], float t_max, float& t);

}  // namespace lampyris

#include "core/scene/shapes/plane_error.h"

#include <algorithm>
#include <limits>

namespace lampyris {

double triangle_plane_error(const glm::dvec3& e1, const glm::dvec3& e2) {
    const double length = glm::length(glm::cross(e1, e2));
    if (!(length > 0.0)) return 0.0;
    const glm::dvec3 u = glm::abs(e1), v = glm::abs(e2), most = glm::max(u, v);
    const glm::dvec3 products(u.y * v.z + u.z * v.y, u.z * v.x + u.x * v.z, u.x * v.y + u.y * v.x);
    return 6.0 * kHalfUlp * std::min(glm::dot(most, products) / length, 16.0 * (most.x + most.y + most.z));
}

float mesh_plane_error(const Mesh& mesh) {
    // As a share of a triangle's longer edge, rays may start so far from it and nobody sees it.
    constexpr double kUnseen = 0x1p-13;
    double error = 0.0, smallest = std::numeric_limits<double>::infinity();
    const auto corner = [&](size_t i) {
        const size_t v = 3 * size_t(mesh.indices[i]);
        return glm::dvec3(mesh.positions[v], mesh.positions[v + 1], mesh.positions[v + 2]);
    };
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const glm::dvec3 p0 = corner(i), e1 = corner(i + 1) - p0, e2 = corner(i + 2) - p0;
        if (glm::cross(e1, e2) == glm::dvec3(0.0)) continue;  // no ray meets it
        const glm::dvec3 longer = glm::max(glm::abs(e1), glm::abs(e2));
        error = std::max(error, triangle_plane_error(e1, e2));
        smallest = std::min(smallest, std::max({longer.x, longer.y, longer.z}));
    }
    return error <= kUnseen * smallest ? float(error) : -1.0f;
}

}  // namespace lampyris

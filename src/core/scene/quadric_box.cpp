#include "core/scene/quadric_box.h"

#include <glm/glm.hpp>

namespace lampyris {

std::array<glm::dvec3, 8> quadric_corners(const Scene& scene, const kernel::GeometryRecord& geometry) {
    const kernel::Quadric& q = geometry.quadric;
    const kernel::TransformRecord& t = scene.transforms[geometry.transform];
    const bool disk = geometry.kind == kernel::GEOMETRY_DISK;
    const double r = q.radius, low = disk ? q.height : q.z_min, high = disk ? q.height : q.z_max;
    std::array<glm::dvec3, 8> corners;
    for (size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec4 p((i & 1u) != 0 ? r : -r, (i & 2u) != 0 ? r : -r, (i & 4u) != 0 ? high : low, 1.0);
        corners[i] = {glm::dot(glm::dvec4(t.to0), p), glm::dot(glm::dvec4(t.to1), p), glm::dot(glm::dvec4(t.to2), p)};
    }
    return corners;
}

}  // namespace lampyris

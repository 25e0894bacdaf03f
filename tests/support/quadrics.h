// Quadrics of four numbers: radius, zmin, zmax, phimax of spheres and cylinders; height, radius, inner radius, phimax of disks.
#pragma once

#include "core/device/kernel_types.h"

namespace lampyris::test {

inline kernel::Quadric quadric_record(uint32_t kind, glm::vec4 numbers) {
    kernel::Quadric q{};
    q.phi_max = numbers.w;
    if (kind == kernel::GEOMETRY_DISK)
        q.height = numbers.x, q.radius = numbers.y, q.inner_radius = numbers.z;
    else
        q.radius = numbers.x, q.z_min = numbers.y, q.z_max = numbers.z;
    return q;
}

}  // namespace lampyris::test

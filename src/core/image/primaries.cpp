#include "core/image/primaries.h"

#include <glm/glm.hpp>

namespace lampyris {

glm::dvec3 xyz_of(glm::dvec2 xy) { return {xy.x / xy.y, 1.0, (1.0 - xy.x - xy.y) / xy.y}; }

glm::dmat3 xyz_from_rgb(const Primaries& p) {
    const glm::dmat3 columns(xyz_of(p.red), xyz_of(p.green), xyz_of(p.blue));
    const glm::dvec3 scale = glm::inverse(columns) * xyz_of(p.white);
    return glm::dmat3(columns[0] * scale.x, columns[1] * scale.y, columns[2] * scale.z);
}

glm::dmat3 rec709_from_rgb(const Primaries& primaries) {
    return glm::inverse(xyz_from_rgb(kRec709)) * xyz_from_rgb(primaries);
}

}  // namespace lampyris

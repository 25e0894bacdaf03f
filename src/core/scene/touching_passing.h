#pragma once

#include "core/scene/scene.h"

#include <vector>

namespace lampyris {

// Which materials let light pass. Those of a stranger's plugin are not known to.
class Passing {
 public:
    explicit Passing(const Scene& scene) : scene_(scene), known_(scene.materials.size(), kUnknown) {}

    bool operator()(const kernel::GeometryRecord& g) {
        return g.alpha_texture != kernel::NONE || g.alpha < 1.0f || material(g.material);
    }
    // Whether it is the boundary of a body, so that "inwards" has a meaning. Shapes that emit stay where their lights are.
    bool is_boundary(const kernel::GeometryRecord& g) const {
        const uint32_t kind = scene_.materials[g.material].kind;
        return (kind == kernel::MATERIAL_DIELECTRIC || kind == kernel::MATERIAL_INTERFACE) &&
               g.kind <= kernel::GEOMETRY_BILINEAR && g.alpha_texture == kernel::NONE && g.alpha >= 1.0f &&
               g.first_light == kernel::NONE;
    }

 private:
    enum Answer : uint8_t { kUnknown, kNo, kYes };

    bool material(uint32_t index);

    const Scene& scene_;
    std::vector<Answer> known_;
};

}  // namespace lampyris

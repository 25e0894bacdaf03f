#include "accel/rays/primitive_kernel.h"

#include "accel/rays/scene_kernel.h"
#include "core/scene/scene.h"

#include <limits>

namespace lampyris {

bool primitive_hit(void* const* scene_buffers, uint32_t geometry, uint32_t primitive, const float origin[3],
                   const float direction[3], float t_max, float& t) {
    kernel::SceneKernel<kernel::kAllEffects> code{scene_buffers, {}, nullptr, nullptr};
    const glm::vec3 o(origin[0], origin[1], origin[2]), d(direction[0], direction[1], direction[2]);
    if (code.geometries[geometry].kind == kernel::GEOMETRY_BILINEAR) {
        glm::vec2 uv;
        return code.bilinear_hit(geometry, primitive, o, d, t_max, t, uv);
    }
    return code.quadric_hit(geometry, o, d, t_max, t);
}

PrimitiveBounds primitive_bounds(const Scene& scene, uint32_t geometry, uint32_t primitive) {
    const kernel::GeometryRecord& record = scene.geometries[geometry];
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    PrimitiveBounds bounds{glm::vec3(kInfinity), glm::vec3(-kInfinity)};
    const auto extend = [&](const glm::vec3& p) {
        bounds.low = glm::min(bounds.low, p);
        bounds.high = glm::max(bounds.high, p);
    };
    if (record.kind == kernel::GEOMETRY_BILINEAR) {
        for (uint32_t i = 0; i < 4; ++i) {
            const float* p = &scene.positions[3 * size_t(record.first_vertex +
                                                         scene.indices[record.first_index + 4 * primitive + i])];
            extend({p[0], p[1], p[2]});
        }
    } else {
        // The full quadric's box. Sweeps cut by phimax use it, too: this costs a few rays, but is correct.
        glm::vec3 low, high;
        const kernel::Quadric& q = record.quadric;
        if (record.kind == kernel::GEOMETRY_DISK) {
            low = {-q.radius, -q.radius, q.height};
            high = {q.radius, q.radius, q.height};
        } else {
            low = {-q.radius, -q.radius, q.z_min};
            high = {q.radius, q.radius, q.z_max};
        }
        const kernel::TransformRecord& m = scene.transforms[record.transform];
        for (int corner = 0; corner < 8; ++corner) {
            const glm::vec4 p(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z,
                              1.0f);
            extend({glm::dot(m.to0, p), glm::dot(m.to1, p), glm::dot(m.to2, p)});
        }
    }
    // Room for the rounding of hits that lie on the box.
    const glm::vec3 slack = 4e-6f * glm::max(glm::abs(bounds.low), glm::abs(bounds.high)) + 1e-30f;
    bounds.low -= slack;
    bounds.high += slack;
    return bounds;
}

}  // namespace lampyris

#include "accel/rays/bvh2_walk.h"

#define KERNEL_TRACER_bvh2 1
#include "accel/rays/scene_kernel.h"

#include <atomic>
#include <glm/vec3.hpp>

namespace lampyris {

bool Bvh2Walk::closest(void* self, const float origin[3], const float direction[3], float t_max, TraceHit& hit) {
    Bvh2Walk& walk = *static_cast<Bvh2Walk*>(self);
    kernel::SceneKernel<kernel::kAllEffects> code{walk.scene_buffers_, {}, nullptr, &walk.unfinished_};
    decltype(code)::Hit found;
    if (!code.trace_closest(glm::vec3(origin[0], origin[1], origin[2]),
                            glm::vec3(direction[0], direction[1], direction[2]), t_max, found))
        return false;
    hit = {found.instance, found.geometry, found.primitive};
    return true;
}

bool Bvh2Walk::occluded(void* self, const float origin[3], const float direction[3], float t_max) {
    Bvh2Walk& walk = *static_cast<Bvh2Walk*>(self);
    kernel::SceneKernel<kernel::kAllEffects> code{walk.scene_buffers_, {}, nullptr, &walk.unfinished_};
    return code.trace_occluded(glm::vec3(origin[0], origin[1], origin[2]),
                               glm::vec3(direction[0], direction[1], direction[2]), t_max);
}

bool Bvh2Walk::take_unfinished() { return std::atomic_ref(unfinished_).exchange(0) != 0; }

}  // namespace lampyris

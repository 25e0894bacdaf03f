// The shaders' ray tracer as C++: what the backend cpu-bvh2 traces with.
#pragma once

#include "core/device/kernel_registry.h"

#include <cstdint>

namespace lampyris {

class Bvh2Walk {
 public:
    // The buffers of a scene with its BVH2, by binding; they must outlive this.
    explicit Bvh2Walk(void* const* scene_buffers) : scene_buffers_(scene_buffers) {}
    // Calls this object, which must not be moved.
    CpuTracer tracer() { return {this, &closest, &occluded}; }
    // Whether the walk of a ray could not finish since the last call.
    bool take_unfinished();

 private:
    static bool closest(void* self, const float origin[3], const float direction[3], float t_max, TraceHit& hit);
    static bool occluded(void* self, const float origin[3], const float direction[3], float t_max);

    void* const* scene_buffers_;
    uint32_t unfinished_ = 0;
};

}  // namespace lampyris

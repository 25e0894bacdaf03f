// A scene's acceleration structures for VK_KHR_ray_query (core/kernel/trace_ray_query.h).
#pragma once

#include "backends/vulkan/acceleration_structure.h"

namespace lampyris {
struct Scene;
}

namespace lampyris::vulkan {

// One bottom level per geometry of the scene (triangles, or boxes of quadrics and patches), and one top level over them: the
// geometries of the world, then those of each instance. An entry's custom index is its geometry, and its instance offset (24
// bits) is its instance, so kernels do not need its index in the top level.
class AccelerationStructures {
 public:
    AccelerationStructures(std::shared_ptr<Context> context, std::shared_ptr<MemoryAccount> account, const Scene& scene,
                           bool staged);
    ~AccelerationStructures();
    vk::AccelerationStructureKHR top_level() const { return *top_.structure; }

 private:
    static AccelerationStructure build_geometry(StructureBuilder& builder, const Scene& scene, uint32_t geometry);

    std::vector<AccelerationStructure> geometries_;
    AccelerationStructure top_;
};

}  // namespace lampyris::vulkan

// Acceleration structures for VK_KHR_ray_query (core/kernel/trace_ray_query.h).
#pragma once

#include "backends/vulkan/memory.h"

namespace lampyris {
struct Scene;
}

namespace lampyris::vulkan {

// One bottom level per geometry of the scene (triangles, or boxes of quadrics and patches), one top level over them: the
// geometries of the world, then those of each instance. An entry's custom index is its geometry; its place in the top
// level's list is not needed: an entry's instance offset (24 bits) holds its instance.
class AccelerationStructures {
 public:
    AccelerationStructures(std::shared_ptr<Context> context, std::shared_ptr<MemoryAccount> account, const Scene& scene,
                           bool staged);
    ~AccelerationStructures();
    vk::AccelerationStructureKHR top_level() const { return *top_.structure; }

 private:
    struct Structure {
        std::unique_ptr<VulkanBuffer> storage;
        vk::raii::AccelerationStructureKHR structure = nullptr;
        vk::DeviceAddress address = 0;
    };
    Structure build(vk::AccelerationStructureTypeKHR type, const vk::AccelerationStructureGeometryKHR& geometry,
                    uint32_t count);
    Structure build_geometry(const Scene& scene, uint32_t geometry);
    std::unique_ptr<VulkanBuffer> input(const void* data, size_t bytes, const char* name);

    std::shared_ptr<Context> context_;
    std::shared_ptr<MemoryAccount> account_;
    bool staged_ = false;
    std::vector<Structure> geometries_;
    Structure top_;
};

}  // namespace lampyris::vulkan

#include "backends/vulkan/scene.h"

#include "backends/vulkan/ray_query.h"
#include "core/bvh/bvh2.h"
#include "core/scene/scene.h"

#include <fmt/format.h>

namespace lampyris::vulkan {

VulkanScene::VulkanScene(std::shared_ptr<Context> context, std::shared_ptr<MemoryAccount> account, const Scene& scene,
                         bool staged, bool ray_query, const VulkanBuffer& unfinished) {
    const auto add = [&](uint32_t binding, const void* data, size_t bytes, const char* name) {
        auto buffer = std::make_unique<VulkanBuffer>(context, account, bytes, fmt::format("the scene's {}", name),
                                                     BufferOptions{.staged = staged});
        if (bytes > 0) buffer->upload(data, bytes, 0);
        bindings_.buffers[binding] = buffer->binding();
        buffers_.push_back(std::move(buffer));
    };
    const auto add_array = [&](uint32_t binding, const auto& array, const char* name) {
        add(binding, array.data(), array.size() * sizeof(array[0]), name);
    };
    Bvh2 bvh;
    kernel::SceneRecord record = scene.record;
    std::vector<kernel::InstanceRecord> instances = scene.instances;
    if (!ray_query) {
        bvh = build_bvh2(scene);
        record.root_node = bvh.roots[0];
        for (size_t i = 0; i < instances.size(); ++i) instances[i].data.z = bvh.roots[i];
    }
    add(0, &record, sizeof record, "record");
    add_array(1, scene.geometries, "geometries");
    add_array(2, scene.indices, "indices");
    add_array(3, scene.positions, "positions");
    add_array(4, scene.normals, "normals");
    add_array(5, scene.uvs, "texture coordinates");
    add_array(6, scene.transforms, "transforms");
    add_array(7, instances, "instances");
    add_array(8, scene.materials, "materials");
    add_array(9, scene.texture_ops, "textures");
    add_array(10, scene.images, "images");
    add_array(11, scene.texels, "texels");
    add_array(12, scene.lights, "lights");
    add_array(13, scene.distributions, "distributions");
    add_array(14, bvh.nodes, "BVH nodes");
    add_array(15, bvh.triangles, "BVH primitives");
    add_array(18, scene.media, "media");
    if (ray_query) {
        structures_ = std::make_unique<AccelerationStructures>(context, account, scene, staged);
        bindings_.top_level = structures_->top_level();
    }
    bindings_.buffers[kUnfinishedBinding] = unfinished.binding();
}

VulkanScene::~VulkanScene() = default;

}  // namespace lampyris::vulkan

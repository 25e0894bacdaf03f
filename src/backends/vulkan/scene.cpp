#include "backends/vulkan/scene.h"

#include "accel/rays/bvh2.h"
#include "backends/vulkan/ray_query.h"

#include <fmt/format.h>

#include <cstddef>

namespace lampyris::vulkan {

VulkanScene::VulkanScene(std::shared_ptr<Context> context, std::shared_ptr<MemoryAccount> account, const Scene& scene,
                         bool staged, bool ray_query, const VulkanBuffer& unfinished) {
    const auto add = [&](const SceneBuffer& from) {
        auto buffer = std::make_unique<VulkanBuffer>(
            context, account, from.bytes, fmt::format("the scene's {}", from.name), BufferOptions{.staged = staged});
        if (from.bytes > 0) buffer->upload(from.data, from.bytes, 0);
        bindings_.buffers[from.binding] = buffer->binding();
        if (from.binding == kernel::BINDING_RECORD) record_ = buffer.get();
        buffers_.push_back(std::move(buffer));
    };
    if (ray_query) {
        for (const SceneBuffer& buffer : scene_buffers(scene)) add(buffer);
        // Nothing reads a BVH in this case, but the kernels' bindings must be filled.
        add({kernel::BINDING_BVH_NODES, nullptr, 0, "BVH nodes"});
        add({kernel::BINDING_BVH_TRIANGLES, nullptr, 0, "BVH primitives"});
        structures_ = std::make_unique<AccelerationStructures>(context, account, scene, staged);
        bindings_.top_level = structures_->top_level();
    } else {
        const Bvh2Scene with_bvh(scene);
        for (const SceneBuffer& buffer : with_bvh.buffers()) add(buffer);
    }
    bindings_.buffers[kernel::BINDING_UNFINISHED] = unfinished.binding();
    bindings_.buffers[kernel::BINDING_PATH_LOG] = unfinished.binding();  // anything, unless the device has a path log
}

VulkanScene::~VulkanScene() = default;

void VulkanScene::set_camera(const kernel::CameraRecord& camera) {
    record_->upload(&camera, sizeof camera, offsetof(kernel::SceneRecord, camera));
}

}  // namespace lampyris::vulkan

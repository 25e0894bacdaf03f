// A scene on a Vulkan device: its buffers, and the structures that trace its rays.
#pragma once

#include "backends/vulkan/kernel.h"

namespace lampyris {
struct Scene;
}

namespace lampyris::vulkan {

class AccelerationStructures;

class VulkanScene final : public DeviceScene {
 public:
    // With ray_query, uses the device's acceleration structures instead of the BVH2.
    VulkanScene(std::shared_ptr<Context> context, std::shared_ptr<MemoryAccount> account, const Scene& scene,
                bool staged, bool ray_query, const VulkanBuffer& unfinished);
    ~VulkanScene() override;
    void set_camera(const kernel::CameraRecord& camera) override;
    const SceneBindings& bindings() const { return bindings_; }

 private:
    std::vector<std::unique_ptr<VulkanBuffer>> buffers_;
    VulkanBuffer* record_ = nullptr;  // one of them
    std::unique_ptr<AccelerationStructures> structures_;
    SceneBindings bindings_;
};

}  // namespace lampyris::vulkan

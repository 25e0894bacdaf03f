#include "backends/vulkan/boxes.h"

namespace lampyris::vulkan {

size_t BoxStructure::build(vk::DeviceAddress boxes, uint32_t count) {
    using Type = vk::AccelerationStructureTypeKHR;
    vk::AccelerationStructureGeometryKHR geometry = boxes_at(boxes);
    geometry.flags = vk::GeometryFlagBitsKHR::eNoDuplicateAnyHitInvocation;  // each box is a candidate once
    builder_.build(bottom_, Type::eBottomLevel, geometry, count, true);
    if (instanced_ != bottom_.address) {
        vk::AccelerationStructureInstanceKHR instance;
        for (size_t i = 0; i < 3; ++i) instance.transform.matrix[i][i] = 1.0f;
        instance.mask = 0xff;
        instance.accelerationStructureReference = bottom_.address;
        instance_ = builder_.input(&instance, sizeof instance, "the instance of boxes");
        instanced_ = bottom_.address;
    }
    // Rebuilt each time, because it holds a copy of the bottom level's bounds.
    builder_.build(top_, Type::eTopLevel, instances_at(instance_->address()), 1, true);
    return bottom_.storage->size() + top_.storage->size() + instance_->size() + builder_.scratch_bytes();
}

}  // namespace lampyris::vulkan

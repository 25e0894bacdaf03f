#include "backends/vulkan/acceleration_structure.h"

namespace lampyris::vulkan {

using Usage = vk::BufferUsageFlagBits;

std::unique_ptr<VulkanBuffer> StructureBuilder::input(const void* data, size_t bytes, const char* name) const {
    auto buffer = std::make_unique<VulkanBuffer>(context_, account_, bytes, name,
                                                 BufferOptions{.staged = staged_, .usage = kBuildInputUsage});
    if (bytes) buffer->upload(data, bytes, 0);
    return buffer;
}

void StructureBuilder::build(AccelerationStructure& into, vk::AccelerationStructureTypeKHR type,
                             const vk::AccelerationStructureGeometryKHR& geometry, uint32_t count, bool again) {
    vk::AccelerationStructureBuildGeometryInfoKHR info;
    info.type = type;
    info.flags = vk::BuildAccelerationStructureFlagBitsKHR::ePreferFastTrace;
    info.mode = vk::BuildAccelerationStructureModeKHR::eBuild;
    info.setGeometries(geometry);
    const auto sizes = context_->device.getAccelerationStructureBuildSizesKHR(
        vk::AccelerationStructureBuildTypeKHR::eDevice, info, count);
    const auto with_room = [&](vk::DeviceSize bytes) { return again ? bytes + bytes / 8 : bytes; };
    if (!into.storage || into.storage->size() < sizes.accelerationStructureSize) {
        const vk::DeviceSize bytes = with_room(sizes.accelerationStructureSize);
        into.structure = nullptr;
        into.storage.reset();  // free the old one before allocating the larger one
        into.storage = std::make_unique<VulkanBuffer>(
            context_, account_, bytes, "an acceleration structure",
            BufferOptions{.staged = staged_,
                          .usage = Usage::eShaderDeviceAddress | Usage::eAccelerationStructureStorageKHR});
        into.structure =
            vk::raii::AccelerationStructureKHR(context_->device, {{}, into.storage->handle(), 0, bytes, type});
        vk::AccelerationStructureDeviceAddressInfoKHR address_info;
        address_info.accelerationStructure = *into.structure;
        into.address = context_->device.getAccelerationStructureAddressKHR(address_info);
    }
    constexpr vk::DeviceSize kScratchAlignment = 256;  // the largest that a device may require
    if (!scratch_ || scratch_->size() < sizes.buildScratchSize + kScratchAlignment) {
        scratch_.reset();
        scratch_ = std::make_unique<VulkanBuffer>(
            context_, account_, with_room(sizes.buildScratchSize) + kScratchAlignment,
            "building an acceleration structure",
            BufferOptions{.staged = staged_, .usage = Usage::eShaderDeviceAddress | Usage::eStorageBuffer});
    }
    info.dstAccelerationStructure = *into.structure;
    info.scratchData.deviceAddress =
        (scratch_->address() + kScratchAlignment - 1) / kScratchAlignment * kScratchAlignment;
    const vk::AccelerationStructureBuildRangeInfoKHR range(count, 0, 0, 0);
    context_->submit([&](vk::raii::CommandBuffer& commands) {
        using Stage = vk::PipelineStageFlagBits;
        using Access = vk::AccessFlagBits;
        // Waits for the writes to the inputs, and for kernels that still traverse the structure's former contents.
        const vk::MemoryBarrier before(
            Access::eTransferWrite | Access::eHostWrite | Access::eShaderWrite | Access::eAccelerationStructureWriteKHR,
            Access::eAccelerationStructureReadKHR | Access::eAccelerationStructureWriteKHR | Access::eShaderRead);
        commands.pipelineBarrier(
            Stage::eTransfer | Stage::eHost | Stage::eComputeShader | Stage::eAccelerationStructureBuildKHR,
            Stage::eAccelerationStructureBuildKHR, {}, before, {}, {});
        commands.buildAccelerationStructuresKHR(info, &range);
        const vk::MemoryBarrier after(Access::eAccelerationStructureWriteKHR, Access::eAccelerationStructureReadKHR);
        commands.pipelineBarrier(Stage::eAccelerationStructureBuildKHR,
                                 Stage::eAccelerationStructureBuildKHR | Stage::eComputeShader, {}, after, {}, {});
    });
}

vk::AccelerationStructureGeometryKHR instances_at(vk::DeviceAddress address) {
    vk::AccelerationStructureGeometryInstancesDataKHR instances;
    instances.data.deviceAddress = address;
    vk::AccelerationStructureGeometryKHR geometry;
    geometry.geometryType = vk::GeometryTypeKHR::eInstances;
    geometry.geometry.setInstances(instances);
    return geometry;
}

vk::AccelerationStructureGeometryKHR boxes_at(vk::DeviceAddress address) {
    vk::AccelerationStructureGeometryAabbsDataKHR boxes;
    boxes.data.deviceAddress = address;
    boxes.stride = sizeof(vk::AabbPositionsKHR);
    vk::AccelerationStructureGeometryKHR geometry;
    geometry.geometryType = vk::GeometryTypeKHR::eAabbs;
    geometry.geometry.setAabbs(boxes);
    return geometry;
}

}  // namespace lampyris::vulkan

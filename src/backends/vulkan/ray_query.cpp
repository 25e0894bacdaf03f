#include "backends/vulkan/ray_query.h"

#include "backends/cpu/primitive_kernel.h"
#include "core/error.h"
#include "core/scene/scene.h"

#include <algorithm>

namespace lampyris::vulkan {
namespace {

using Usage = vk::BufferUsageFlagBits;
constexpr auto kInputUsage = Usage::eShaderDeviceAddress | Usage::eAccelerationStructureBuildInputReadOnlyKHR;

// Rows 0 to 2 of an affine transform, as Vulkan wants them.
vk::TransformMatrixKHR matrix_of(const kernel::TransformRecord& m) {
    vk::TransformMatrixKHR result;
    const kernel::vec4 rows[3] = {m.to0, m.to1, m.to2};
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 4; ++c) result.matrix[size_t(r)][size_t(c)] = rows[r][c];
    }
    return result;
}

}  // namespace

AccelerationStructures::AccelerationStructures(std::shared_ptr<Context> context, std::shared_ptr<MemoryAccount> account,
                                               const Scene& scene, bool staged)
    : context_(std::move(context)), account_(std::move(account)), staged_(staged) {
    for (uint32_t g = 0; g < scene.geometries.size(); ++g) geometries_.push_back(build_geometry(scene, g));
    std::vector<vk::AccelerationStructureInstanceKHR> entries;
    for (uint32_t i = 0; i < std::max<size_t>(scene.instances.size(), 1); ++i) {
        const GeometrySet& set = scene.sets[i == 0 ? 0 : scene.instance_sets[i]];
        kernel::TransformRecord identity{};
        identity.to0.x = identity.to1.y = identity.to2.z = 1.0f;
        for (uint32_t g = set.first_geometry; g < set.first_geometry + set.geometry_count; ++g) {
            if (geometries_[g].address == 0) continue;
            vk::AccelerationStructureInstanceKHR entry;
            entry.transform = matrix_of(i == 0 ? identity : scene.instances[i].transform);
            entry.instanceCustomIndex = g & 0xffffffu;
            entry.mask = 0xff;
            entry.instanceShaderBindingTableRecordOffset = i & 0xffffffu;
            entry.setFlags(vk::GeometryInstanceFlagBitsKHR::eTriangleFacingCullDisable);
            entry.accelerationStructureReference = geometries_[g].address;
            entries.push_back(entry);
        }
    }
    const auto data =
        input(entries.data(), entries.size() * sizeof(entries[0]), "the instances of the acceleration structure");
    vk::AccelerationStructureGeometryInstancesDataKHR instances;
    instances.data.deviceAddress = data->address();
    vk::AccelerationStructureGeometryKHR geometry;
    geometry.geometryType = vk::GeometryTypeKHR::eInstances;
    geometry.geometry.setInstances(instances);
    top_ = build(vk::AccelerationStructureTypeKHR::eTopLevel, geometry, uint32_t(entries.size()));
}

AccelerationStructures::~AccelerationStructures() = default;

std::unique_ptr<VulkanBuffer> AccelerationStructures::input(const void* data, size_t bytes, const char* name) {
    auto buffer = std::make_unique<VulkanBuffer>(context_, account_, bytes, name,
                                                 BufferOptions{.staged = staged_, .usage = kInputUsage});
    if (bytes) buffer->upload(data, bytes, 0);
    return buffer;
}

AccelerationStructures::Structure AccelerationStructures::build_geometry(const Scene& scene, uint32_t index) {
    const kernel::GeometryRecord& record = scene.geometries[index];
    vk::AccelerationStructureGeometryKHR geometry;
    geometry.flags = vk::GeometryFlagBitsKHR::eOpaque;
    if (record.data.x == kernel::GEOMETRY_TRIANGLES) {
        const uint32_t count = record.attributes.z;
        if (count == 0) return {};
        const uint32_t* indices = &scene.indices[record.data.z];
        const uint32_t vertices = *std::max_element(indices, indices + 3 * size_t(count)) + 1;
        const auto index_data =
            input(indices, 3 * size_t(count) * sizeof(uint32_t), "triangles for the acceleration structure");
        const auto vertex_data = input(&scene.positions[3 * size_t(record.data.w)],
                                       3 * size_t(vertices) * sizeof(float), "vertices for the acceleration structure");
        vk::AccelerationStructureGeometryTrianglesDataKHR triangles;
        triangles.vertexFormat = vk::Format::eR32G32B32Sfloat;
        triangles.vertexData.deviceAddress = vertex_data->address();
        triangles.vertexStride = 3 * sizeof(float);
        triangles.maxVertex = vertices - 1;
        triangles.indexType = vk::IndexType::eUint32;
        triangles.indexData.deviceAddress = index_data->address();
        geometry.geometryType = vk::GeometryTypeKHR::eTriangles;
        geometry.geometry.setTriangles(triangles);
        return build(vk::AccelerationStructureTypeKHR::eBottomLevel, geometry, count);
    }
    geometry.flags = {};  // the kernel decides whether a box's primitive is hit
    const uint32_t count = record.data.x == kernel::GEOMETRY_BILINEAR ? record.attributes.z : 1;
    std::vector<vk::AabbPositionsKHR> boxes;
    for (uint32_t p = 0; p < count; ++p) {
        const PrimitiveBounds b = primitive_bounds(scene, index, p);
        boxes.emplace_back(b.low.x, b.low.y, b.low.z, b.high.x, b.high.y, b.high.z);
    }
    if (boxes.empty()) return {};
    const auto box_data = input(boxes.data(), boxes.size() * sizeof(boxes[0]), "boxes for the acceleration structure");
    vk::AccelerationStructureGeometryAabbsDataKHR aabbs;
    aabbs.data.deviceAddress = box_data->address();
    aabbs.stride = sizeof(boxes[0]);
    geometry.geometryType = vk::GeometryTypeKHR::eAabbs;
    geometry.geometry.setAabbs(aabbs);
    return build(vk::AccelerationStructureTypeKHR::eBottomLevel, geometry, count);
}

AccelerationStructures::Structure AccelerationStructures::build(vk::AccelerationStructureTypeKHR type,
                                                                const vk::AccelerationStructureGeometryKHR& geometry,
                                                                uint32_t count) {
    vk::AccelerationStructureBuildGeometryInfoKHR info;
    info.type = type;
    info.flags = vk::BuildAccelerationStructureFlagBitsKHR::ePreferFastTrace;
    info.mode = vk::BuildAccelerationStructureModeKHR::eBuild;
    info.setGeometries(geometry);
    const auto sizes = context_->device.getAccelerationStructureBuildSizesKHR(
        vk::AccelerationStructureBuildTypeKHR::eDevice, info, count);
    Structure result;
    result.storage = std::make_unique<VulkanBuffer>(
        context_, account_, sizes.accelerationStructureSize, "an acceleration structure",
        BufferOptions{.staged = staged_,
                      .usage = Usage::eShaderDeviceAddress | Usage::eAccelerationStructureStorageKHR});
    result.structure = vk::raii::AccelerationStructureKHR(
        context_->device, {{}, result.storage->handle(), 0, sizes.accelerationStructureSize, type});
    constexpr vk::DeviceSize kScratchAlignment = 256;  // the largest that the specification lets a device ask for
    const VulkanBuffer scratch(
        context_, account_, sizes.buildScratchSize + kScratchAlignment, "building an acceleration structure",
        BufferOptions{.staged = staged_, .usage = Usage::eShaderDeviceAddress | Usage::eStorageBuffer});
    info.dstAccelerationStructure = *result.structure;
    info.scratchData.deviceAddress =
        (scratch.address() + kScratchAlignment - 1) / kScratchAlignment * kScratchAlignment;
    const vk::AccelerationStructureBuildRangeInfoKHR range(count, 0, 0, 0);
    context_->submit([&](vk::raii::CommandBuffer& commands) {
        using Stage = vk::PipelineStageFlagBits;
        using Access = vk::AccessFlagBits;
        const vk::MemoryBarrier before(
            Access::eTransferWrite | Access::eHostWrite | Access::eAccelerationStructureWriteKHR,
            Access::eAccelerationStructureReadKHR | Access::eAccelerationStructureWriteKHR | Access::eShaderRead);
        commands.pipelineBarrier(Stage::eTransfer | Stage::eHost | Stage::eAccelerationStructureBuildKHR,
                                 Stage::eAccelerationStructureBuildKHR, {}, before, {}, {});
        commands.buildAccelerationStructuresKHR(info, &range);
        const vk::MemoryBarrier after(Access::eAccelerationStructureWriteKHR, Access::eAccelerationStructureReadKHR);
        commands.pipelineBarrier(Stage::eAccelerationStructureBuildKHR,
                                 Stage::eAccelerationStructureBuildKHR | Stage::eComputeShader, {}, after, {}, {});
    });
    vk::AccelerationStructureDeviceAddressInfoKHR address_info;
    address_info.accelerationStructure = *result.structure;
    result.address = context_->device.getAccelerationStructureAddressKHR(address_info);
    return result;
}

}  // namespace lampyris::vulkan

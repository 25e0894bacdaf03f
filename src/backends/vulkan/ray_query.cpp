#include "backends/vulkan/ray_query.h"

#include "accel/rays/primitive_kernel.h"
#include "core/base/error.h"
#include "core/scene/scene.h"

#include <algorithm>

namespace lampyris::vulkan {
namespace {

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
                                               const Scene& scene, bool staged) {
    StructureBuilder builder(std::move(context), std::move(account), staged);
    for (uint32_t g = 0; g < scene.geometries.size(); ++g) geometries_.push_back(build_geometry(builder, scene, g));
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
    const auto data = builder.input(entries.data(), entries.size() * sizeof(entries[0]),
                                    "the instances of the acceleration structure");
    builder.build(top_, vk::AccelerationStructureTypeKHR::eTopLevel, instances_at(data->address()),
                  uint32_t(entries.size()));
}

AccelerationStructures::~AccelerationStructures() = default;

AccelerationStructure AccelerationStructures::build_geometry(StructureBuilder& builder, const Scene& scene,
                                                             uint32_t index) {
    AccelerationStructure result;
    const kernel::GeometryRecord& record = scene.geometries[index];
    if (record.kind == kernel::GEOMETRY_TRIANGLES) {
        const uint32_t count = record.primitive_count;
        if (count == 0) return result;
        const uint32_t* indices = &scene.indices[record.first_index];
        const uint32_t vertices = *std::max_element(indices, indices + 3 * size_t(count)) + 1;
        const auto index_data =
            builder.input(indices, 3 * size_t(count) * sizeof(uint32_t), "triangles for the acceleration structure");
        const auto vertex_data =
            builder.input(&scene.positions[3 * size_t(record.first_vertex)], 3 * size_t(vertices) * sizeof(float),
                          "vertices for the acceleration structure");
        vk::AccelerationStructureGeometryTrianglesDataKHR triangles;
        triangles.vertexFormat = vk::Format::eR32G32B32Sfloat;
        triangles.vertexData.deviceAddress = vertex_data->address();
        triangles.vertexStride = 3 * sizeof(float);
        triangles.maxVertex = vertices - 1;
        triangles.indexType = vk::IndexType::eUint32;
        triangles.indexData.deviceAddress = index_data->address();
        vk::AccelerationStructureGeometryKHR geometry;
        geometry.flags = vk::GeometryFlagBitsKHR::eOpaque;
        geometry.geometryType = vk::GeometryTypeKHR::eTriangles;
        geometry.geometry.setTriangles(triangles);
        builder.build(result, vk::AccelerationStructureTypeKHR::eBottomLevel, geometry, count);
        return result;
    }
    const uint32_t count = record.kind == kernel::GEOMETRY_BILINEAR ? record.primitive_count : 1;
    std::vector<vk::AabbPositionsKHR> boxes;
    for (uint32_t p = 0; p < count; ++p) {
        const PrimitiveBounds b = primitive_bounds(scene, index, p);
        boxes.emplace_back(b.low.x, b.low.y, b.low.z, b.high.x, b.high.y, b.high.z);
    }
    if (boxes.empty()) return result;
    const auto box_data =
        builder.input(boxes.data(), boxes.size() * sizeof(boxes[0]), "boxes for the acceleration structure");
    // Not opaque: the kernel decides whether a box's primitive is hit.
    builder.build(result, vk::AccelerationStructureTypeKHR::eBottomLevel, boxes_at(box_data->address()), count);
    return result;
}

}  // namespace lampyris::vulkan

// The scene as flat arrays, ready for any backend, and the effects that it needs.
#pragma once

#include "core/device/effects.h"
#include "core/device/kernel_types.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lampyris {

// A geometry set that is instanced as one: the world (set 0) or an object.
struct GeometrySet {
    uint32_t first_geometry = 0, geometry_count = 0;
};

// No slot of the material has a texture.
inline void forget_textures(kernel::MaterialRecord& m) {
    m.bump_texture = m.normal_map = m.amount_texture = kernel::NONE;
    m.color0_texture = m.color1_texture = m.color2_texture = kernel::NONE;
    m.roughness_u_texture = m.roughness_v_texture = m.thickness_texture = kernel::NONE;
    m.coat_roughness_u_texture = m.coat_roughness_v_texture = kernel::NONE;
}

// Arrays are those of core/kernel/scene_buffers.h, element for element (layouts in core/kernel/layout.h).
struct Scene {
    kernel::SceneRecord record{};
    std::vector<kernel::GeometryRecord> geometries;
    std::vector<uint32_t> indices;  // 3 a triangle, 4 a patch; relative to the geometry's first vertex
    std::vector<float> positions;   // 3 a vertex; at least 16 readable bytes past the last one (Embree reads them)
    std::vector<float> normals;     // 3 a vertex
    std::vector<float> uvs;         // 2 a vertex
    std::vector<kernel::TransformRecord> transforms;
    std::vector<kernel::InstanceRecord> instances;  // [0] is the world
    std::vector<kernel::MaterialRecord> materials;
    std::vector<kernel::TextureOp> texture_ops;
    std::vector<kernel::ImageRecord> images;
    std::vector<uint32_t> texels;
    std::vector<kernel::LightRecord> lights;
    std::vector<uint32_t> distributions;
    std::vector<kernel::LightNode> light_nodes;  // with EFFECT_LIGHT_TREE
    std::vector<kernel::MediumRecord> media;  // empty, or [0] is empty space
    std::vector<GeometrySet> sets;            // [0] is the world
    std::vector<uint32_t> instance_sets;      // set of each instance; [0] = 0

    Effects effects;
    // Writes the effects that the scene needs into its record, for kernels.
    void record_effects(uint64_t mask) {
        record.effects_low = uint32_t(mask);
        record.effects_high = uint32_t(mask >> 32);
    }
    std::string name;                      // file name of the scene
    std::vector<std::string> notes;        // what was mapped or ignored, for the user to know ("Sampler zsobol: ...")
    std::vector<std::string> unsupported;  // with --skip-unsupported: what was left out
    uint64_t hash = 0;                     // of everything above

    uint32_t width() const { return record.camera.resolution_x; }
    uint32_t height() const { return record.camera.resolution_y; }
};

}  // namespace lampyris

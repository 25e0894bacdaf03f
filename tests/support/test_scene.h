// Scenes put together by hand, record by record, for tests of kernels that read a scene.
#pragma once

#include "core/scene/area_lights.h"
#include "core/scene/light_distribution.h"
#include "core/scene/scene.h"
#include "support/quadrics.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <vector>

namespace lampyris::test {

inline kernel::TransformRecord transform_of(const glm::dmat4& to) {
    const glm::dmat4 from = glm::inverse(to);
    const auto row = [](const glm::dmat4& m, int i) {
        return glm::vec4(float(m[0][i]), float(m[1][i]), float(m[2][i]), float(m[3][i]));
    };
    return {row(to, 0), row(to, 1), row(to, 2), row(from, 0), row(from, 1), row(from, 2)};
}

class TestScene {
 public:
    Scene scene;
    std::vector<double> powers;  // of the lights, in order

    TestScene() {
        scene.transforms.push_back(transform_of(glm::dmat4(1.0)));
        scene.instances.push_back({scene.transforms[0], 0, 0, 0, 0});
        scene.instance_sets.push_back(0);
        kernel::MaterialRecord material{};
        material.kind = kernel::MATERIAL_DIFFUSE;
        forget_textures(material);
        material.color0 = kernel::Spectrum(0.5f);
        scene.materials.push_back(material);
    }

    uint32_t add_geometry(uint32_t kind, uint32_t flags, uint32_t primitives) {
        kernel::GeometryRecord g{};
        g.kind = kind;
        g.flags = flags;
        g.first_index = uint32_t(scene.indices.size());
        g.first_vertex = uint32_t(scene.positions.size() / 3);
        g.first_light = g.alpha_texture = kernel::NONE;
        g.first_normal = uint32_t(scene.normals.size() / 3);
        g.first_uv = uint32_t(scene.uvs.size() / 2);
        g.primitive_count = primitives;
        g.alpha = 1.0f;
        scene.geometries.push_back(g);
        return uint32_t(scene.geometries.size() - 1);
    }
    uint32_t add_quadric(uint32_t kind, glm::vec4 params, const glm::dmat4& to = glm::dmat4(1.0), uint32_t flags = 0) {
        const uint32_t index = add_geometry(kind, flags, 1);
        scene.geometries[index].quadric = quadric_record(kind, params);
        scene.geometries[index].transform = uint32_t(scene.transforms.size());
        scene.transforms.push_back(transform_of(to));
        return index;
    }
    // Four corners make a bilinear patch (p00, p10, p01, p11), three a triangle.
    template <size_t n>
    uint32_t add_polygon(const std::array<glm::vec3, n>& corners, uint32_t flags = 0) {
        static_assert(n == 3 || n == 4);
        const uint32_t index = add_geometry(n == 3 ? kernel::GEOMETRY_TRIANGLES : kernel::GEOMETRY_BILINEAR, flags, 1);
        for (uint32_t i = 0; i < n; ++i) {
            scene.indices.push_back(i);
            for (int axis = 0; axis < 3; ++axis) scene.positions.push_back(corners[i][axis]);
        }
        return index;
    }
    // Makes a geometry of one primitive a light.
    uint32_t add_area_light(uint32_t geometry, glm::vec3 radiance, uint32_t flags = 0) {
        kernel::GeometryRecord& g = scene.geometries[geometry];
        kernel::LightRecord light{};
        const bool triangle = g.kind == kernel::GEOMETRY_TRIANGLES;
        if (triangle) {
            std::array<glm::vec3, 3> p;
            for (uint32_t i = 0; i < 3; ++i) {
                const float* v = &scene.positions[3 * (g.first_vertex + scene.indices[g.first_index + i])];
                p[i] = {v[0], v[1], v[2]};
            }
            light = triangle_light(p[0], p[1], p[2], g.flags);
        }
        light.kind = triangle ? kernel::LIGHT_TRIANGLE : kernel::LIGHT_GEOMETRY;
        light.flags = flags;
        light.image = light.transform = kernel::NONE;
        light.geometry = geometry;
        g.first_light = uint32_t(scene.lights.size());
        return add_light(light, radiance);
    }
    uint32_t add_light(kernel::LightRecord light, glm::vec3 emission, float power = 1.0f) {
        light.emission = spectrum_of_rgb(emission);
        scene.lights.push_back(light);
        powers.push_back(power);
        return uint32_t(scene.lights.size() - 1);
    }
    // A picture of floats, one channel, row by row from the top.
    uint32_t add_image(const std::vector<float>& values, uint32_t width, uint32_t height, uint32_t wrap) {
        kernel::ImageRecord image{};
        image.first_texel = uint32_t(scene.texels.size());
        image.width = width;
        image.height = height;
        image.format = kernel::TEXEL_R32F | wrap << 8 | kernel::FILTER_POINT << 16;
        for (const float value : values) scene.texels.push_back(std::bit_cast<uint32_t>(value));
        scene.images.push_back(image);
        return uint32_t(scene.images.size() - 1);
    }

    // Fills in derived values. Empty arrays get an unused element, so that every backend can bind them.
    const Scene& finish() {
        choose_lights(scene, powers);
        scene.sets.assign(1, {0, uint32_t(scene.geometries.size())});
        scene.record.geometry_count = uint32_t(scene.geometries.size());
        scene.record.instance_count = 1;
        scene.record_effects(kernel::kAllEffects);
        scene.record.bounds = glm::vec4(0.0f, 0.0f, 0.0f, 100.0f);
        scene.positions.resize(scene.positions.size() + 4);
        const auto at_least_one = [](auto& array) {
            if (array.empty()) array.resize(1);
        };
        at_least_one(scene.indices);
        at_least_one(scene.normals);
        at_least_one(scene.uvs);
        at_least_one(scene.texture_ops);
        at_least_one(scene.images);
        at_least_one(scene.texels);
        at_least_one(scene.lights);
        at_least_one(scene.distributions);
        return scene;
    }
};

}  // namespace lampyris::test

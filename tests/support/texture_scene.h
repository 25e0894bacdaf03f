// A scene of one far triangle, to which tests add texture programs, images and materials.
#pragma once

#include "core/device/device.h"
#include "core/scene/noise_table.h"
#include "core/scene/scene.h"
#include "support/device_run.h"

#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace lampyris::test {

using kernel::TextureOp;

struct TextureScene {
    Scene scene;

    TextureScene() {
        kernel::TransformRecord identity{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0},
                                         {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
        scene.transforms.push_back(identity);
        scene.instances.push_back({identity, 0, 1, 0, 0});
        scene.instance_sets.push_back(0);
        scene.sets.push_back({0, 1});
        add_geometry(kernel::NONE, 1.0f);
        scene.positions = {1e6f, 0, 0, 1e6f, 1, 0, 1e6f, 0, 1};
        scene.positions.resize(16);
        scene.indices = {0, 1, 2};
        scene.normals = scene.uvs = {0.0f};
        scene.distributions = {0u};
        scene.texels.assign(std::begin(kNoisePermutation), std::end(kNoisePermutation));  // noise finds its table at 0
        scene.images.resize(1);
        scene.lights.resize(1);
        scene.record.geometry_count = 1;
        scene.record.instance_count = 1;
        scene.record_effects(kernel::kAllEffects);
    }

    // Only the first geometry is traced; the others are only queried for their opacity.
    uint32_t add_geometry(uint32_t alpha_texture, float alpha) {
        kernel::GeometryRecord g{};
        g.kind = kernel::GEOMETRY_TRIANGLES;
        g.first_light = kernel::NONE;
        g.alpha_texture = alpha_texture;
        g.primitive_count = 1;
        g.alpha = alpha;
        scene.geometries.push_back(g);
        return uint32_t(scene.geometries.size() - 1);
    }
    uint32_t add_program(std::vector<TextureOp> ops) {
        ops.back().flags |= 1u;
        const uint32_t first = uint32_t(scene.texture_ops.size());
        scene.texture_ops.insert(scene.texture_ops.end(), ops.begin(), ops.end());
        return first;
    }
    uint32_t add_image(const std::vector<uint32_t>& words, uint32_t width, uint32_t height, uint32_t format,
                       uint32_t wrap, uint32_t filtering, uint32_t decode = 0) {
        kernel::ImageRecord image{};
        image.first_texel = uint32_t(scene.texels.size());
        image.width = width;
        image.height = height;
        image.format = format | wrap << 8 | filtering << 16;
        image.decoding = decode;
        scene.texels.insert(scene.texels.end(), words.begin(), words.end());
        scene.images.push_back(image);
        return uint32_t(scene.images.size() - 1);
    }
    // A material without textures; the test changes the record that it gets.
    kernel::MaterialRecord& add_material(uint32_t kind, uint32_t flags = 0) {
        kernel::MaterialRecord m{};
        m.kind = kind;
        m.flags = flags;
        forget_textures(m);
        m.eta = 1.5f;
        m.max_depth = 10;
        m.samples = 1;
        scene.materials.push_back(m);
        return scene.materials.back();
    }

    // Runs a test kernel over the probes on a backend.
    template <typename Answer, typename Probe>
    std::vector<Answer> run(const std::string& backend, const char* file, const std::vector<Probe>& probes) {
        if (scene.texture_ops.empty()) scene.texture_ops.resize(1);
        if (scene.materials.empty()) add_material(kernel::MATERIAL_DIFFUSE);
        // One device and one compiled kernel for all runs: a shader takes seconds to compile.
        static std::map<std::string, std::unique_ptr<Device>> devices;
        static std::map<std::pair<std::string, std::string>, KernelHandle> kernels;
        std::unique_ptr<Device>& device = devices[backend];
        if (!device) device = create_device(backend, exact_options(backend));
        KernelHandle& kernel = kernels[{backend, file}];
        if (!kernel) kernel = device->compile(file, kernel::kAllEffects);
        const DeviceSceneHandle uploaded = device->upload(scene);
        const BufferHandle in = device->create_buffer(probes.size() * sizeof(Probe), "probes");
        const BufferHandle out = device->create_buffer(probes.size() * sizeof(Answer), "answers");
        in->upload(probes.data(), probes.size() * sizeof(Probe));
        const NamedBuffer buffers[] = {{"probes", in}, {"answers", out}};
        device->run(*kernel, uploaded.get(), buffers, 0, uint32_t(probes.size()));
        std::vector<Answer> answers(probes.size());
        out->download(answers.data(), answers.size() * sizeof(Answer));
        return answers;
    }
};

inline TextureOp operation(uint32_t kind, uint32_t mapping = kernel::MAPPING_UV, uint32_t option = 0) {
    TextureOp op{};
    op.operation = kind;
    op.flags = mapping << 8;
    op.option = option;
    op.m0 = {1, 1, 0, 0};
    return op;
}
inline TextureOp constant_op(glm::vec3 value) {
    TextureOp op = operation(kernel::TEXTURE_CONSTANT, kernel::MAPPING_NONE);
    op.a = glm::vec4(value, 0.0f);
    return op;
}

// Records without padding compare by their bytes: backends must agree to the bit.
template <typename T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

}  // namespace lampyris::test

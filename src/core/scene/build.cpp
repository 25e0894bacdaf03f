#include "core/scene/build.h"

#include "core/scene/build_lights.h"
#include "core/scene/build_shapes.h"
#include "core/scene/builder.h"
#include "core/scene/film.h"

#include <cstddef>
#include <cstring>
#include <type_traits>

namespace lampyris {

namespace {

// FNV-1a over 8-byte words (Fowler, Noll, Vo). It only serves to tell scenes apart.
void mix_hash(uint64_t& hash, const void* data, size_t bytes) {
    const auto* at = static_cast<const unsigned char*>(data);
    for (; bytes > 0;) {
        uint64_t word = 0;
        const size_t n = bytes < sizeof word ? bytes : sizeof word;
        std::memcpy(&word, at, n);
        hash = (hash ^ word) * 0x100000001b3ull;
        hash ^= hash >> 29;
        at += n, bytes -= n;
    }
}

template <typename T>
void mix_hash(uint64_t& hash, const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const uint64_t count = values.size();
    mix_hash(hash, &count, sizeof count);
    mix_hash(hash, values.data(), values.size() * sizeof(T));
}

uint64_t hash_of(const Scene& scene) {
    uint64_t hash = 0xcbf29ce484222325ull;
    mix_hash(hash, &scene.record, sizeof scene.record);
    mix_hash(hash, scene.geometries);
    mix_hash(hash, scene.indices);
    mix_hash(hash, scene.positions);
    mix_hash(hash, scene.normals);
    mix_hash(hash, scene.uvs);
    mix_hash(hash, scene.transforms);
    mix_hash(hash, scene.instances);
    mix_hash(hash, scene.materials);
    mix_hash(hash, scene.texture_ops);
    mix_hash(hash, scene.images);
    mix_hash(hash, scene.texels);
    mix_hash(hash, scene.lights);
    mix_hash(hash, scene.distributions);
    mix_hash(hash, scene.media);
    mix_hash(hash, scene.light_nodes);
    return hash;
}

}  // namespace

BuiltScene build_scene(SceneDescription&& description, const BuildOptions& options, Diagnostics& diagnostics) {
    BuiltScene built;
    Scene& scene = built.scene;
    struct Parts {
        Parts(SceneDescription& d, const BuildOptions& o, Scene& s, SceneSettings& t, Diagnostics& g)
            : context{d, o, s, t, g, textures, {}, {}, {}, {}, {}, {}, {}}, textures(context) {}
        BuildContext context;
        TextureBuilder textures;
    } parts(description, options, scene, built.settings, diagnostics);
    BuildContext& context = parts.context;

    context.choose_media();
    build_view(context);
    build_shapes(context);
    build_lights(context);
    context.textures.define_all();  // mistakes in unused textures are reported, too
    context.check_unused_materials();
    context.check_unused_media();
    finish_lights(context);
    scene.record.geometry_count = uint32_t(scene.geometries.size());
    scene.record.instance_count = uint32_t(scene.instances.size());
    scene.record.root_node = kernel::NONE;
    scene.record_effects(scene.effects.mask());
    // Embree reads 16 bytes at every vertex, the last one included.
    scene.positions.insert(scene.positions.end(), 4, 0.0f);
    scene.unsupported = diagnostics.unsupported_list();
    scene.hash = hash_of(scene);
    return built;
}

}  // namespace lampyris

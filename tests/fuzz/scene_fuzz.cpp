// Any text that parses is built into arrays whose indices lead somewhere, or is an InputError: never a crash, a hang, or
// more memory than a text of a few kilobytes deserves. The names of files in it are looked for in the corpus' folder.
#include "core/scene/build.h"

#include <algorithm>
#include <cassert>

using namespace lampyris;

namespace {

bool within(size_t first, size_t count, size_t size) { return first <= size && count <= size - first; }
bool none_or_below(uint32_t index, size_t size) { return index == kNone || index < size; }

void check_geometry(const Scene& scene, const kernel::GeometryRecord& g) {
    assert(g.ids.x < scene.materials.size());
    assert(none_or_below(g.ids.y, scene.lights.size()));
    assert(none_or_below(g.ids.z, scene.texture_ops.size()));
    if (g.data.x > kernel::GEOMETRY_BILINEAR) {
        assert(g.ids.w < scene.transforms.size());
        return;
    }
    const size_t entries = size_t(g.attributes.z) * (g.data.x == kernel::GEOMETRY_TRIANGLES ? 3 : 4);
    assert(within(g.data.z, entries, scene.indices.size()));
    for (size_t i = 0; i < entries; ++i) {
        const size_t corner = scene.indices[g.data.z + i];
        // Embree reads 16 bytes at every vertex.
        assert(within(3 * (g.data.w + corner), 4, scene.positions.size()));
        if (g.data.y & kernel::GEOMETRY_HAS_NORMALS)
            assert(within(3 * (g.attributes.x + corner), 3, scene.normals.size()));
        if (g.data.y & kernel::GEOMETRY_HAS_UVS) assert(within(2 * (g.attributes.y + corner), 2, scene.uvs.size()));
    }
}

void check_material(const Scene& scene, const kernel::MaterialRecord& m) {
    const size_t operations = scene.texture_ops.size();
    assert(none_or_below(m.data.z, operations) && none_or_below(m.data.w, scene.images.size()));
    for (int i = 0; i < 4; ++i) assert(none_or_below(m.textures[i], operations));
    for (int i = 0; i < 4; ++i) assert(none_or_below(m.textures2[i], operations));
    if (m.data.x != kernel::MATERIAL_MIX) return;
    assert(m.extra.x < scene.materials.size() && m.extra.y < scene.materials.size());
    assert(none_or_below(m.extra.z, operations));
}

void check_textures(const Scene& scene) {
    for (const kernel::TextureOp& operation : scene.texture_ops) {
        if (operation.data.x == kernel::TEXTURE_IMAGE) assert(operation.data.z < scene.images.size());
    }
    // Every program ends.
    assert(scene.texture_ops.empty() || (scene.texture_ops.back().data.y & 1));
    for (const kernel::ImageRecord& image : scene.images) {
        const bool grey_bytes = (image.data.w & 0xff) == kernel::TEXEL_R8;
        const size_t pixels = size_t(image.data.y) * image.data.z;
        assert(pixels > 0 && within(image.data.x, grey_bytes ? (pixels + 3) / 4 : pixels, scene.texels.size()));
    }
}

void check_light(const Scene& scene, const kernel::LightRecord& light) {
    assert(none_or_below(light.data.w, scene.transforms.size()));
    const bool area = light.data.x <= kernel::LIGHT_GEOMETRY;
    assert(none_or_below(light.data.z, area ? scene.texture_ops.size() : scene.images.size()));
    if (area) assert(light.ids.x < scene.geometries.size());
    if (light.data.x == kernel::LIGHT_INFINITE_IMAGE) {
        const size_t width = light.ids.y, height = light.ids.z;
        assert(within(light.ids.x, height + 1 + height * (width + 1), scene.distributions.size()));
    }
}

void check(const Scene& scene) {
    for (const kernel::GeometryRecord& geometry : scene.geometries) check_geometry(scene, geometry);
    for (const kernel::MaterialRecord& material : scene.materials) check_material(scene, material);
    for (const kernel::LightRecord& light : scene.lights) check_light(scene, light);
    check_textures(scene);
    assert(scene.record.light_count == scene.lights.size() && scene.record.infinite_lights <= scene.lights.size());
    assert(scene.lights.empty() || within(scene.record.light_cdf, scene.lights.size() + 1, scene.distributions.size()));
    for (const GeometrySet& set : scene.sets)
        assert(within(set.first_geometry, set.geometry_count, scene.geometries.size()));
    assert(!scene.instances.empty() && scene.instances.size() == scene.instance_sets.size());
    for (const uint32_t set : scene.instance_sets) assert(set < scene.sets.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    std::string text(reinterpret_cast<const char*>(data), size);
    // Without a slash, which no escape sequence can bring back, no name leads out of the folder.
    std::replace(text.begin(), text.end(), '/', '_');
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    diagnostics.set_skip_unsupported(size % 2 == 0);
    try {
        SceneDescription description =
            parse_scene_text("fuzz.pbrt", std::move(text), LAMPYRIS_FUZZ_FOLDER, sources, diagnostics);
        const BuiltScene built = build_scene(std::move(description), {}, diagnostics);
        diagnostics.throw_if_errors();
        check(built.scene);
    } catch (const InputError&) {}
    return 0;
}

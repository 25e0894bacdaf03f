// Any text that parses is either built into arrays whose indices are in range, or is an InputError: never a crash, a hang, or
// more memory than a text of a few kilobytes deserves. Files that it names are searched for in the corpus' folder.
#include "core/scene/build.h"

#include <algorithm>
#include <cassert>

using namespace lampyris;

namespace {

bool within(size_t first, size_t count, size_t size) { return first <= size && count <= size - first; }
bool none_or_below(uint32_t index, size_t size) { return index == kNone || index < size; }

void check_geometry(const Scene& scene, const kernel::GeometryRecord& g) {
    assert(g.material < scene.materials.size());
    assert(none_or_below(g.first_light, scene.lights.size()));
    assert(none_or_below(g.alpha_texture, scene.texture_ops.size()));
    if (g.kind > kernel::GEOMETRY_BILINEAR) {
        assert(g.transform < scene.transforms.size());
        return;
    }
    const size_t entries = size_t(g.primitive_count) * (g.kind == kernel::GEOMETRY_TRIANGLES ? 3 : 4);
    assert(within(g.first_index, entries, scene.indices.size()));
    for (size_t i = 0; i < entries; ++i) {
        const size_t corner = scene.indices[g.first_index + i];
        // Embree reads 16 bytes at every vertex.
        assert(within(3 * (g.first_vertex + corner), 4, scene.positions.size()));
        if (g.flags & kernel::GEOMETRY_HAS_NORMALS)
            assert(within(3 * (g.first_normal + corner), 3, scene.normals.size()));
        if (g.flags & kernel::GEOMETRY_HAS_UVS) assert(within(2 * (g.first_uv + corner), 2, scene.uvs.size()));
    }
}

void check_material(const Scene& scene, const kernel::MaterialRecord& m) {
    const size_t operations = scene.texture_ops.size();
    assert(none_or_below(m.bump_texture, operations) && none_or_below(m.normal_map, scene.images.size()));
    for (const uint32_t texture :
         {m.color0_texture, m.color1_texture, m.color2_texture, m.roughness_u_texture, m.roughness_v_texture,
          m.thickness_texture, m.coat_roughness_u_texture, m.coat_roughness_v_texture})
        assert(none_or_below(texture, operations));
    if (m.kind != kernel::MATERIAL_MIX) return;
    assert(m.first_material < scene.materials.size() && m.second_material < scene.materials.size());
    assert(none_or_below(m.amount_texture, operations));
}

void check_textures(const Scene& scene) {
    for (const kernel::TextureOp& operation : scene.texture_ops) {
        if (operation.operation == kernel::TEXTURE_IMAGE) assert(operation.image < scene.images.size());
    }
    // Every texture program has an end.
    assert(scene.texture_ops.empty() || (scene.texture_ops.back().flags & 1));
    for (const kernel::ImageRecord& image : scene.images) {
        const bool grey_bytes = (image.format & 0xff) == kernel::TEXEL_R8;
        const size_t pixels = size_t(image.width) * image.height;
        assert(pixels > 0 && within(image.first_texel, grey_bytes ? (pixels + 3) / 4 : pixels, scene.texels.size()));
    }
}

void check_light(const Scene& scene, const kernel::LightRecord& light) {
    assert(none_or_below(light.transform, scene.transforms.size()));
    const bool area = light.kind <= kernel::LIGHT_GEOMETRY;
    assert(none_or_below(light.image, area ? scene.texture_ops.size() : scene.images.size()));
    if (area) assert(light.geometry < scene.geometries.size());
    if (light.kind == kernel::LIGHT_INFINITE_IMAGE) {
        const size_t width = scene.images[light.image].width, height = scene.images[light.image].height;
        assert(within(light.distribution, height + 1 + height * (width + 1), scene.distributions.size()));
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
    // Without slashes, no name leads out of the folder. (Escape sequences cannot produce any.)
    std::replace(text.begin(), text.end(), '/', '_');
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    diagnostics.set_skip_unsupported(size % 2 == 0);
    try {
        SceneDescription description =
            parse_scene_text("fuzz.pbrt", std::move(text), std::string(LAMPYRIS_FUZZ_FOLDER), sources, diagnostics);
        const BuiltScene built = build_scene(std::move(description), {}, diagnostics);
        diagnostics.throw_if_errors();
        check(built.scene);
    } catch (const InputError&) {}
    return 0;
}

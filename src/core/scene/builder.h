// What the parts of the scene's builder share: the registries of scene plugins, and the context that a plugin's factory
// gets. A plugin is one file in shapes/, textures/, media/, lights/, cameras/ or filters/ whose last line registers it; a material is
// a folder in src/materials/.
#pragma once

#include "core/base/parameters.h"
#include "core/base/registry.h"
#include "core/scene/build.h"
#include "core/scene/spectrum.h"
#include "core/scene/texture_builder.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace lampyris {

struct BuildContext;

// A directive that needs effects. Its location is computed only when somebody reads it.
struct Asker {
    const BuildContext* build = nullptr;
    const Entity* entity = nullptr;
    const char* directive = "";
    std::string operator()() const;  // "scene.pbrt:12:1 (Material \"dielectric\")"
};

// An area light as its directive says it, ready to be given to a shape.
struct AreaLight {
    bool valid = false;
    bool two_sided = false;
    Spectrum radiance{0.0f};
    uint32_t texture = kNone;         // emission program; replaces `radiance`
    glm::vec3 texture_average{0.0f};  // mean radiance, for choosing lights
    float power = 0.0f;               // the requested power, in the units of the scene; 0: none
    float power_luminance = 1.0f;     // luminance per unit of scale, as "power" counts it
    Asker asked_by;
};

// The state of one build. Plugins append to `scene` and report to `diagnostics`.
struct BuildContext {
    SceneDescription& description;
    const BuildOptions& options;
    Scene& scene;
    SceneSettings& settings;
    Diagnostics& diagnostics;
    TextureBuilder& textures;

    // Lights are kept in three groups, because the infinite ones come first in Scene::lights, and distant ones next. Powers serve
    // as weights.
    struct PendingLight {
        kernel::LightRecord record;
        double power = 0.0;  // luminous; of infinite and distant lights: per unit of the scene's radius squared
        bool scales_with_scene = false;
        Location location;  // of the directive
    };
    std::vector<PendingLight> infinite_lights, distant_lights, lights;

    // The record of SceneDescription::materials[i] (kNone: pbrt-v4's default, diffuse 0.5), built on first use. `path` holds
    // the materials that are being built, outermost first: a mix must not contain itself.
    uint32_t material(uint32_t description_index, const std::vector<uint32_t>& path = {});
    std::unordered_map<uint32_t, uint32_t> built_materials;
    // The index of a named material in the description, or kNone.
    uint32_t named_material(const std::string& name);
    std::unordered_map<std::string_view, uint32_t> named_materials;  // filled on first use
    std::unordered_map<uint32_t, uint32_t> mix_depths;  // nesting depth of mixes, by index in Scene::materials
    // Materials that nothing uses are not built; unknown types and parameters are still reported.
    void check_unused_materials();

    // See Effects::ask.
    template <typename AskedBy>
    void ask(uint64_t effect, const AskedBy& asked_by) {
        scene.effects.ask(effect, asked_by);
    }
    // A file name in the scene, relative to the scene file's folder.
    std::string resolve(const std::string& filename) const;
    // Appends a transform and returns its index. Reports an error at `where` if it is singular.
    uint32_t add_transform(const glm::mat4& to, Location where);
    // Reads from the Integrator directive whether media are simulated. Must be called first.
    void choose_media();
    // The record of SceneDescription::media[i] (kNone: empty space), built on first use.
    uint32_t medium(uint32_t description_index);
    std::unordered_map<uint32_t, uint32_t> built_media;
    // The same as check_unused_materials, for media.
    void check_unused_media();
    // Diagnostics::unsupported if the transform moves.
    void refuse_motion(const AnimatedTransform& transform, Location where);
};

kernel::TransformRecord transform_record(const glm::mat4& to);
// Whether a transform has an inverse whose elements are finite floats.
bool invertible(const glm::mat4& to);
// The range in which images are correct (tests/numerics/scale_test.cpp): tracers, Embree among them, form products of three
// lengths, which must not overflow a float.
constexpr float kLargestCoordinate = 1e12f;
constexpr float kSmallestScene = 1e-9f;  // radius of the bounding sphere
bool swaps_handedness(const glm::mat4& m);

// ---- Values that a texture may replace -------------------------------------------------------------------------------

struct ColorSlot {
    Spectrum value{0.0f};
    uint32_t texture = kNone;
    bool given = false;
    bool is_black() const { return texture == kNone && value == Spectrum(0.0f); }
};
struct FloatSlot {
    float value = 0.0f;
    uint32_t texture = kNone;
    bool given = false;
};
ColorSlot read_color(BuildContext& context, ParameterReader& reader, std::string_view name, SpectrumUse use,
                     Spectrum default_value);
FloatSlot read_float(BuildContext& context, ParameterReader& reader, std::string_view name);
// One spectrum, without textures; `default_value` where it is absent or wrong.
Spectrum read_spectrum(BuildContext& context, ParameterReader& reader, std::string_view name, SpectrumUse use,
                       Spectrum default_value);

// ---- Plugins ---------------------------------------------------------------------------------------------------------

struct ShapeContext {
    BuildContext& build;
    ShapeDescription& shape;
    ParameterReader& reader;
    uint32_t material = 0;  // into Scene::materials
    const AreaLight* area_light = nullptr;
    bool in_object = false;
    Asker asked_by;

    // Appends a geometry record with material, alpha, orientation and media filled in. The caller adds the fields that its kind
    // needs (layout.h), and its lights (area_lights.h).
    uint32_t add_geometry(uint32_t kind, uint32_t flags, uint32_t primitive_count);
};
using ShapeFactory = void (*)(ShapeContext&);
Registry<ShapeFactory>& shape_registry();

struct MaterialContext {
    BuildContext& build;
    MaterialDescription& material;
    ParameterReader& reader;
    kernel::MaterialRecord& record;
    Asker asked_by;
    std::vector<uint32_t> path;  // see BuildContext::material; ends with the current one
    void ask(uint64_t effect) { build.ask(effect, asked_by); }
};
using MaterialFactory = void (*)(MaterialContext&);
// MaterialRecord::roughest_alpha: the roughness of a material's roughest lobe. Photons are stored on a surface if an eye path may
// gather there, that is, if this roughness is no less than the integrator's `glossy`. A material that sets nothing counts as
// diffuse.
constexpr float kRoughestDiffuse = 1e30f;
constexpr float kNeverGathers = 0.0f;  // only delta lobes
Registry<MaterialFactory>& material_registry();

struct MediumContext {
    BuildContext& build;
    MediumDescription& medium;
    ParameterReader& reader;
    kernel::MediumRecord& record;
    // Diagnostics::unsupported for a medium that does more than absorb; empty space takes its place.
    void refuse(std::string_view parameter, const std::string& with_what, const std::string& hint);
};
using MediumFactory = void (*)(MediumContext&);
Registry<MediumFactory>& medium_registry();

struct LightContext {
    BuildContext& build;
    LightDescription& light;
    ParameterReader& reader;
    Asker asked_by;
    void ask(uint64_t effect) { build.ask(effect, asked_by); }
};
using LightFactory = void (*)(LightContext&);
Registry<LightFactory>& light_registry();

struct CameraContext {
    BuildContext& build;
    CameraDescription& camera;
    ParameterReader& reader;
    kernel::CameraRecord& record;
    glm::vec2 resolution;
    Asker asked_by;
};
using CameraFactory = void (*)(CameraContext&);
Registry<CameraFactory>& camera_registry();

struct FilterContext {
    BuildContext& build;
    ParameterReader& reader;
    kernel::CameraRecord& record;
};
using FilterFactory = void (*)(FilterContext&);
Registry<FilterFactory>& filter_registry();

// The parameters that every shape has ("alpha") are added to its own.
struct RegisterShape {
    RegisterShape(const char* name, const char* summary, ParameterSpecs specs, ShapeFactory factory);
};
// Materials that bend the shading normal add "displacement" and "normalmap" (materials/shared/host.h).
struct RegisterMaterial {
    RegisterMaterial(const char* name, const char* summary, ParameterSpecs specs, MaterialFactory factory);
};
struct RegisterMedium {
    RegisterMedium(const char* name, const char* summary, ParameterSpecs specs, MediumFactory factory);
};
struct RegisterLight {
    RegisterLight(const char* name, const char* summary, ParameterSpecs specs, LightFactory factory);
};
struct RegisterCamera {
    RegisterCamera(const char* name, const char* summary, ParameterSpecs specs, CameraFactory factory);
};
struct RegisterFilter {
    RegisterFilter(const char* name, const char* summary, ParameterSpecs specs, FilterFactory factory);
};

}  // namespace lampyris

// The content of a scene file, directive by directive, before anything is interpreted. It is the first stage of
// scene.pbrt -> SceneDescription -> Scene + Effects -> Device -> Integrator -> Film.
//
// The parser resolves the graphics state (transforms, attributes, named things) and snapshots it into each entity;
// every token and parameter keeps its location. Nothing here knows what a "diffuse" material is.
#pragma once

#include "core/base/parameter_list.h"
#include "core/scene/scene_folder.h"

#include <glm/mat4x4.hpp>

#include <array>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

// Object/light/camera space to world, at the two ends of the shutter; equal unless ActiveTransform made them differ.
struct AnimatedTransform {
    std::array<glm::mat4, 2> matrix{glm::mat4(1.0f), glm::mat4(1.0f)};
    // A matrix that overflowed holds numbers that are not equal to themselves.
    bool animated() const {
        return std::memcmp(&matrix[0], &matrix[1], sizeof matrix[0]) != 0 && matrix[0] != matrix[1];
    }
};

inline constexpr uint32_t kNone = 0xffffffffu;

struct CameraDescription : Entity {
    AnimatedTransform world_from_camera;
    uint32_t medium = kNone;
};

struct TextureDescription : Entity {  // Texture "name" "spectrum" "imagemap"; `type` is the class
    std::string name;
    bool is_spectrum = false;
    AnimatedTransform world_from_texture;
};

struct MaterialDescription : Entity {  // `type` of a named material is its "string type"
    std::string name;                  // empty for Material
};

struct MediumDescription : Entity {
    std::string name;
    AnimatedTransform world_from_medium;
};

struct LightDescription : Entity {
    AnimatedTransform world_from_light;
    uint32_t medium = kNone;
};

struct ShapeDescription : Entity {
    AnimatedTransform world_from_object;  // inside ObjectBegin: object-definition space
    bool reverse_orientation = false;
    uint32_t material = kNone;    // into SceneDescription::materials
    uint32_t area_light = kNone;  // into SceneDescription::area_lights
    uint32_t interior_medium = kNone, exterior_medium = kNone;
};

struct ObjectDescription {  // ObjectBegin ... ObjectEnd
    std::string name;
    Location location;
    std::vector<ShapeDescription> shapes;
};

struct InstanceDescription {
    uint32_t object = kNone;
    Location location;
    AnimatedTransform world_from_object;
};

struct SceneDescription {
    std::shared_ptr<Sources> sources;
    SceneFolder folder;
    CameraDescription camera;
    Entity sampler, film, pixel_filter, integrator, accelerator;  // not given(): pbrt's defaults
    ParameterList options;  // of Option directives; names in lower case without "_" and "-", as pbrt compares them
    std::string color_space = "srgb";  // of the film: the one in force at the Film directive
    float transform_start_time = 0.0f, transform_end_time = 1.0f;  // when the two matrices of an AnimatedTransform hold
    std::vector<TextureDescription>
        textures;  // in order of definition; float and spectrum textures have separate names
    std::vector<MaterialDescription> materials;
    std::vector<MediumDescription> media;
    std::vector<LightDescription> lights;
    std::vector<Entity> area_lights;
    std::vector<ShapeDescription> shapes;
    std::vector<ObjectDescription> objects;
    std::vector<InstanceDescription> instances;
};

// Reads a scene file and its includes. Errors are collected in `diagnostics`; parsing continues after an error where possible.
// Throws InputError only if the file cannot be read at all.
// `sources` owns the texts, so it must live as long as locations are shown. It must be the one that `diagnostics` was made
// with.
// It may read files in `allowed` folders, too.
SceneDescription parse_scene_file(const std::string& path, std::shared_ptr<Sources> sources, Diagnostics& diagnostics,
                                  std::vector<std::string> allowed = {});
// The same for a text in memory (tests, fuzzing, standard input).
SceneDescription parse_scene_text(std::string name, std::string text, SceneFolder folder,
                                  std::shared_ptr<Sources> sources, Diagnostics& diagnostics);

}  // namespace lampyris

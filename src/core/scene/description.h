// The content of a scene file, directive by directive, before anything is interpreted. It is the first stage of
// scene.pbrt -> SceneDescription -> Scene + Effects -> Device -> Integrator -> Film.
//
// The parser resolves the graphics state (transforms, attributes, named things) and snapshots it into each entity;
// every token and parameter keeps its location. Nothing here knows what a "diffuse" material is.
#pragma once

#include "core/error.h"

#include <glm/mat4x4.hpp>

#include <array>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace lampyris {

enum class ParameterType {
    kBool,
    kInteger,
    kFloat,
    kPoint2,
    kVector2,
    kPoint3,
    kVector3,
    kNormal,
    kRgb,
    kBlackbody,
    kSpectrum,
    kString,
    kTexture
};

// One `"type name" [ values ]`. Numbers of integer parameters are ints; of bools, one byte each; everything numeric
// else is float (a spectrum given as wavelength-value pairs too; a spectrum by name is strings).
struct Parameter {
    ParameterType type;
    std::string name;
    Location location;                      // of the "type name" string
    Location value_location;                // of the first value
    std::string_view color_space = "srgb";  // the colour space of rgb values: one of kColorSpaces
    std::variant<std::vector<float>, std::vector<int32_t>, std::vector<uint8_t>, std::vector<std::string>> values;
    mutable bool used = false;  // set by the getters; a parameter that no getter read is an error
};

const char* type_name(ParameterType type);  // "point3", ...
inline constexpr std::array<std::string_view, 4> kColorSpaces{"srgb", "rec2020", "aces2065-1", "dci-p3"};

// The parameters of one directive. Getters mark a parameter as used, and report a wrong type or count to Diagnostics (returning
// the default). If the parameter exists with another type, the error names both types.
class ParameterList {
 public:
    std::vector<Parameter> parameters;
    std::vector<std::string> malformed;  // names of parameters that could not be read, which was reported

    const Parameter* find(std::string_view name) const;  // marks as used
    const Parameter* find(std::string_view name, ParameterType type) const;
    bool has(std::string_view name) const;  // does not mark

    float get_float(std::string_view name, float default_value, Diagnostics& diagnostics) const;
    int32_t get_int(std::string_view name, int32_t default_value, Diagnostics& diagnostics) const;
    bool get_bool(std::string_view name, bool default_value, Diagnostics& diagnostics) const;
    std::string get_string(std::string_view name, const std::string& default_value, Diagnostics& diagnostics) const;
    // A string that must be one of `choices`.
    std::string get_choice(std::string_view name, const std::string& default_value,
                           const std::vector<std::string>& choices, Diagnostics& diagnostics) const;
    // Fixed-size tuples: point2, vector3, rgb, ...; nothing when absent.
    std::vector<float> get_floats(std::string_view name, ParameterType type, size_t count,
                                  Diagnostics& diagnostics) const;
    // The whole array of a parameter (P, N, uv, indices); empty when absent. Moves the storage out: large meshes are not copied.
    std::vector<float> take_floats(std::string_view name, ParameterType type, Diagnostics& diagnostics);
    std::vector<int32_t> take_ints(std::string_view name, Diagnostics& diagnostics);
    // Adds the parameters that are missing here (Attribute's defaults). They count as used: a default may apply to some types
    // only.
    void add_defaults(const std::vector<Parameter>& defaults);
    bool all_used() const;
    // Every parameter that no getter read becomes an error, with the known names as a hint.
    void report_unused(const std::string& of_what, const std::vector<std::string>& known,
                       Diagnostics& diagnostics) const;
};

// A directive with a quoted type: Camera "perspective", Shape "sphere", ...
struct Entity {
    std::string type;
    Location location;       // of the directive
    Location type_location;  // of its type string
    ParameterList parameters;
    bool given() const { return location.known(); }
};

// Object/light/camera space to world, at the two ends of the shutter; equal unless ActiveTransform made them differ.
struct AnimatedTransform {
    std::array<glm::mat4, 2> matrix{glm::mat4(1.0f), glm::mat4(1.0f)};
    bool animated() const { return matrix[0] != matrix[1]; }
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
    std::string directory;  // folder of the scene file: relative file names start here
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
SceneDescription parse_scene_file(const std::string& path, std::shared_ptr<Sources> sources, Diagnostics& diagnostics);
// The same for a text in memory (tests, fuzzing, standard input); `directory` is where its Includes are looked for.
SceneDescription parse_scene_text(std::string name, std::string text, const std::string& directory,
                                  std::shared_ptr<Sources> sources, Diagnostics& diagnostics);

}  // namespace lampyris

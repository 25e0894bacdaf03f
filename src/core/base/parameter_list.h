// The parameters of a directive of a scene file: named values, each of a type.
#pragma once

#include "core/base/error.h"

#include <array>
#include <cstddef>
#include <cstdint>
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

struct ParameterTypeInfo {
    const char* name;  // in scene files
    ParameterType type;
    size_t tuple;  // numbers are given in multiples of this
};
inline constexpr ParameterTypeInfo kParameterTypes[] = {
    {"bool", ParameterType::kBool, 1},         {"integer", ParameterType::kInteger, 1},
    {"float", ParameterType::kFloat, 1},       {"point2", ParameterType::kPoint2, 2},
    {"vector2", ParameterType::kVector2, 2},   {"point3", ParameterType::kPoint3, 3},
    {"vector3", ParameterType::kVector3, 3},   {"normal", ParameterType::kNormal, 3},
    {"rgb", ParameterType::kRgb, 3},           {"blackbody", ParameterType::kBlackbody, 1},
    {"spectrum", ParameterType::kSpectrum, 2}, {"string", ParameterType::kString, 1},
    {"texture", ParameterType::kTexture, 1},
};
constexpr const ParameterTypeInfo& type_info(ParameterType type) { return kParameterTypes[static_cast<size_t>(type)]; }
constexpr const char* type_name(ParameterType type) { return type_info(type).name; }

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

}  // namespace lampyris

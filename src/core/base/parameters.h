// Parameters, each declared once: name, type, default, range or choices, unit, documentation. Defaults, range checks,
// errors about unknown names, `lampyris plugins` and the reference page come from the declaration.
//
// Scene plugins (shapes, materials, ...) declare a list of ParameterSpec and read the values of a directive through a
// ParameterReader. Integrators and photon maps declare theirs for the kernel, with PARAMS (core/kernel/params.h);
// PARAMETER_FIELDS and specs_of() make the same specs of that.
#pragma once

#include "core/base/error.h"
#include "core/base/parameter_list.h"

#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace lampyris {

struct ParameterSpec {
    std::string name;
    ParameterType type = ParameterType::kFloat;  // kSpectrum: rgb, blackbody or spectrum
    bool array = false;                          // any number of values
    bool texturable = false;                     // a texture may be given instead of the value
    bool spectral = false;                       // for floats: a spectrum may be given instead
    bool required = false;
    double number = 0.0;  // default of floats, integers and bools
    std::string text;     // default of strings; for all other types, what leaving it out means
    double minimum = -std::numeric_limits<double>::infinity();
    double maximum = std::numeric_limits<double>::infinity();
    bool above_minimum = false;        // the minimum itself is outside
    std::vector<std::string> choices;  // of strings
    std::string unit;
    std::string doc;

    // Chained onto one of the functions below: real("radius", 1, "radius").above(0).in("scene units").
    ParameterSpec&& at_least(double low) && {
        minimum = low;
        return std::move(*this);
    }
    ParameterSpec&& above(double low) && {
        minimum = low, above_minimum = true;
        return std::move(*this);
    }
    ParameterSpec&& between(double low, double high) && {
        minimum = low, maximum = high;
        return std::move(*this);
    }
    ParameterSpec&& one_of(std::vector<std::string> list) && {
        choices = std::move(list);
        return std::move(*this);
    }
    ParameterSpec&& in(std::string of) && {
        unit = std::move(of);
        return std::move(*this);
    }
    ParameterSpec&& textured() && {
        texturable = true;
        return std::move(*this);
    }
    ParameterSpec&& needed() && {
        required = true;
        return std::move(*this);
    }

    bool contains(double value) const;            // false for NaN
    std::string type_text() const;                // "float or texture", "string, one of a, b"
    std::string number_text(double value) const;  // integers with all digits
    std::string range_text() const;               // "above 0", "1 to 1024"; empty if there is no range
    std::string default_text() const;
};
using ParameterSpecs = std::vector<ParameterSpec>;

ParameterSpec real(std::string name, double default_value, std::string doc);
ParameterSpec integer(std::string name, int default_value, std::string doc);
ParameterSpec boolean(std::string name, bool default_value, std::string doc);
ParameterSpec text(std::string name, std::string default_value, std::string doc);
// A choice among the names in braces at the start of `doc`: "{race|priority} who stays".
ParameterSpec choice(std::string name, size_t default_index, std::string_view doc);
// Tuples, spectra, textures and whole arrays have no default value here: `absent` says what leaving the parameter out means.
ParameterSpec value(std::string name, ParameterType type, std::string absent, std::string doc);
ParameterSpec values(std::string name, ParameterType type, std::string absent, std::string doc);

std::vector<std::string> spec_names(const ParameterSpecs& specs);
const ParameterSpec* find_spec(const ParameterSpecs& specs, std::string_view name);

// Reads one directive's parameters against its specs. Errors are reported to the diagnostics, and the default is returned.
// Reading a name without a spec is a bug (std::logic_error).
class ParameterReader {
 public:
    ParameterReader(const ParameterSpecs& specs, Entity& entity, Diagnostics& diagnostics);

    bool has(std::string_view name) const;
    float get_float(std::string_view name);
    int32_t get_int(std::string_view name);
    bool get_bool(std::string_view name);
    std::string get_string(std::string_view name);
    std::vector<float> get_tuple(std::string_view name, size_t count);  // empty when absent or wrong
    std::vector<float> take_floats(std::string_view name);              // whole arrays, moved out
    std::vector<int32_t> take_ints(std::string_view name);
    const Parameter* find(std::string_view name);    // the parameter of that name, of any type; marks it as used
    Location location(std::string_view name) const;  // of the value, or of the directive if the parameter is absent

    // A message at a parameter (or at the directive, if the parameter is absent).
    void error(std::string_view name, std::string message, std::string hint = {});
    void warning(std::string_view name, std::string message, std::string hint = {});
    // To be called last: a parameter that nobody read is an error, which lists the known names. `kind` is that of the plugin
    // ("shape").
    void finish(std::string_view kind);

    const ParameterSpecs& specs() const { return *specs_; }
    Entity& entity() { return *entity_; }
    Diagnostics& diagnostics() { return *diagnostics_; }

 private:
    const ParameterSpec& spec(std::string_view name) const;
    bool check(const ParameterSpec& spec, double value);
    const ParameterSpecs* specs_;
    Entity* entity_;
    Diagnostics* diagnostics_;
};

// ---- Parameters of integrators and photon maps: members of a plain struct --------------------------------------------

// One member of a struct declared with PARAMS: an int, uint or float. A uint whose documentation begins with "{a|b|c} " is a
// choice among these names; its value is the index of the name, from 0.
struct ParameterField {
    ParameterSpec spec;
    size_t offset = 0;
    enum class Type { kInt, kUint, kFloat } type = Type::kFloat;
};
using ParameterFields = std::vector<ParameterField>;

template <typename T>
requires std::same_as<T, int> || std::same_as<T, unsigned> || std::same_as<T, float> ParameterField
parameter_field(const char* name, size_t offset, double default_value, double low, double high, const char* doc) {
    using Type = ParameterField::Type;
    if (doc[0] == '{') return {choice(name, size_t(default_value), doc), offset, Type::kUint};
    ParameterSpec spec =
        std::is_same_v<T, float> ? real(name, default_value, doc) : integer(name, int(default_value), doc);
    return {std::move(spec).between(low, high), offset,
            std::is_same_v<T, float> ? Type::kFloat
            : std::is_same_v<T, int> ? Type::kInt
                                     : Type::kUint};
}

#define LAMPYRIS_PARAMETER_FIELD(type, name, default_value, low, high, doc) \
    ::lampyris::parameter_field<type>(#name, offsetof(Struct, name), default_value, low, high, doc),
// The fields of a struct declared with PARAMS(S, LIST), as an expression.
#define PARAMETER_FIELDS(S, LIST)                                           \
    [] {                                                                    \
        using Struct [[maybe_unused]] = S;                                  \
        return ::lampyris::ParameterFields{LIST(LAMPYRIS_PARAMETER_FIELD)}; \
    }()

ParameterSpecs specs_of(const ParameterFields& fields);
// Writes every default into the struct.
void set_defaults(void* target, const ParameterFields& fields);
// Overwrites the members that the directive gives. Unknown names are left to the caller's report_unused (an integrator shares
// its directive with others: see spec_names).
void read_parameters(void* target, const ParameterFields& fields, const ParameterList& list, Diagnostics& diagnostics);
// The same from the command line: one "key=value". Throws InputError for an unknown key, or a malformed or out-of-range value;
// `of_what` names the plugin in the message ("integrator \"ao\"").
void set_parameter(void* target, const ParameterFields& fields, std::string_view key, std::string_view value,
                   const std::string& of_what);
// The current value of every field, for statistics and metadata: name and value as text.
std::vector<std::pair<std::string, std::string>> show_parameters(const void* source, const ParameterFields& fields);

// "name:key=value,key=value" as on the command line and in "string photon_map". Throws InputError if it is malformed.
struct PluginChoice {
    std::string name;
    std::vector<std::pair<std::string, std::string>> settings;
};
PluginChoice parse_plugin_choice(std::string_view text);
// "key=value,key=value"
std::vector<std::pair<std::string, std::string>> parse_settings(std::string_view text);

}  // namespace lampyris

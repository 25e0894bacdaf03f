// ParameterList: how the stages after the parser read parameters.
#include "core/base/parameter_list.h"

#include <algorithm>

namespace lampyris {
namespace {

std::string quoted(ParameterType type, std::string_view name) {
    return std::string("\"") + type_name(type) + " " + shown(name) + "\"";
}

size_t value_count(const Parameter& parameter) {
    return std::visit([](const auto& values) { return values.size(); }, parameter.values);
}

void report_type(const Parameter& parameter, ParameterType wanted, Diagnostics& diagnostics) {
    diagnostics.error(parameter.location,
                      "parameter \"" + shown(parameter.name) + "\" is of type " + type_name(wanted) + ", not " +
                          type_name(parameter.type),
                      "write " + quoted(wanted, parameter.name));
}

void report_count(const Parameter& parameter, const std::string& wanted, Diagnostics& diagnostics) {
    const size_t count = value_count(parameter);
    diagnostics.error(parameter.value_location.known() ? parameter.value_location : parameter.location,
                      "parameter " + quoted(parameter.type, parameter.name) + " takes " + wanted + ", but has " +
                          (count == 0 ? std::string("none") : std::to_string(count)));
}

// The parameter of that name, marked as used; nothing where it is absent or of another type, which is reported.
const Parameter* find_typed(const ParameterList& list, std::string_view name, ParameterType type,
                            Diagnostics& diagnostics) {
    const Parameter* parameter = list.find(name);
    if (!parameter || parameter->type == type) return parameter;
    report_type(*parameter, type, diagnostics);
    return nullptr;
}

template <typename T>
T get_one(const ParameterList& list, std::string_view name, ParameterType type, T default_value,
          Diagnostics& diagnostics) {
    const Parameter* parameter = find_typed(list, name, type, diagnostics);
    if (!parameter) return default_value;
    const auto* values = std::get_if<std::vector<T>>(&parameter->values);
    if (!values || values->size() != 1) {
        report_count(*parameter, "one value", diagnostics);
        return default_value;
    }
    return values->front();
}

template <typename T>
std::vector<T> take(ParameterList& list, std::string_view name, ParameterType type, Diagnostics& diagnostics) {
    const Parameter* parameter = find_typed(list, name, type, diagnostics);
    if (!parameter) return {};
    // The list is not const here, so the parameter in it is not const either.
    auto* values = std::get_if<std::vector<T>>(&const_cast<Parameter*>(parameter)->values);
    return values ? std::move(*values) : std::vector<T>();
}

}  // namespace

const Parameter* ParameterList::find(std::string_view name) const {
    for (const Parameter& parameter : parameters) {
        if (parameter.name != name) continue;
        parameter.used = true;
        return &parameter;
    }
    return nullptr;
}

const Parameter* ParameterList::find(std::string_view name, ParameterType type) const {
    for (const Parameter& parameter : parameters) {
        if (parameter.name != name || parameter.type != type) continue;
        parameter.used = true;
        return &parameter;
    }
    return nullptr;
}

bool ParameterList::has(std::string_view name) const {
    return std::any_of(parameters.begin(), parameters.end(), [&](const Parameter& p) { return p.name == name; });
}

float ParameterList::get_float(std::string_view name, float default_value, Diagnostics& diagnostics) const {
    return get_one<float>(*this, name, ParameterType::kFloat, default_value, diagnostics);
}

int32_t ParameterList::get_int(std::string_view name, int32_t default_value, Diagnostics& diagnostics) const {
    return get_one<int32_t>(*this, name, ParameterType::kInteger, default_value, diagnostics);
}

bool ParameterList::get_bool(std::string_view name, bool default_value, Diagnostics& diagnostics) const {
    return get_one<uint8_t>(*this, name, ParameterType::kBool, default_value, diagnostics) != 0;
}

std::string ParameterList::get_string(std::string_view name, const std::string& default_value,
                                      Diagnostics& diagnostics) const {
    return get_one<std::string>(*this, name, ParameterType::kString, default_value, diagnostics);
}

std::string ParameterList::get_choice(std::string_view name, const std::string& default_value,
                                      const std::vector<std::string>& choices, Diagnostics& diagnostics) const {
    std::string value = get_string(name, default_value, diagnostics);
    if (value == default_value || std::find(choices.begin(), choices.end(), value) != choices.end()) return value;
    const Parameter* parameter = find(name, ParameterType::kString);
    diagnostics.error(parameter ? parameter->value_location : Location{},
                      "\"" + shown(value) + "\" is not a value of " + quoted(ParameterType::kString, name) +
                          did_you_mean(value, choices),
                      "it is one of " + list_of(choices));
    return default_value;
}

std::vector<float> ParameterList::get_floats(std::string_view name, ParameterType type, size_t count,
                                             Diagnostics& diagnostics) const {
    const Parameter* parameter = find_typed(*this, name, type, diagnostics);
    if (!parameter) return {};
    const auto* values = std::get_if<std::vector<float>>(&parameter->values);
    if (!values || values->size() != count) {
        report_count(*parameter, std::to_string(count) + (count == 1 ? " number" : " numbers"), diagnostics);
        return {};
    }
    return *values;
}

std::vector<float> ParameterList::take_floats(std::string_view name, ParameterType type, Diagnostics& diagnostics) {
    return take<float>(*this, name, type, diagnostics);
}

std::vector<int32_t> ParameterList::take_ints(std::string_view name, Diagnostics& diagnostics) {
    return take<int32_t>(*this, name, ParameterType::kInteger, diagnostics);
}

void ParameterList::add_defaults(const std::vector<Parameter>& defaults) {
    const size_t own = parameters.size();
    for (const Parameter& candidate : defaults) {
        const auto end = parameters.begin() + static_cast<ptrdiff_t>(own);
        if (std::any_of(parameters.begin(), end, [&](const Parameter& p) { return p.name == candidate.name; }))
            continue;
        parameters.push_back(candidate);
        parameters.back().used = true;
    }
}

bool ParameterList::all_used() const {
    return std::all_of(parameters.begin(), parameters.end(), [](const Parameter& parameter) { return parameter.used; });
}

void ParameterList::report_unused(const std::string& of_what, const std::vector<std::string>& known,
                                  Diagnostics& diagnostics) const {
    for (const Parameter& parameter : parameters) {
        if (parameter.used) continue;
        const bool is_known = std::find(known.begin(), known.end(), parameter.name) != known.end();
        std::string message = "parameter \"" + shown(parameter.name) + "\" ";
        message += is_known ? "has no effect here for " + of_what : "is unknown to " + of_what;
        if (!is_known) message += did_you_mean(parameter.name, known);
        std::string hint;
        if (!is_known) hint = known.empty() ? "it takes no parameters" : "its parameters are " + list_of(known);
        diagnostics.error(parameter.location, message, hint);
    }
}

}  // namespace lampyris

#include "core/base/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace lampyris {

namespace {

ParameterSpec make_spec(std::string name, ParameterType type, double number, std::string text, std::string doc) {
    ParameterSpec spec;
    spec.name = std::move(name);
    spec.type = type;
    spec.number = number;
    spec.text = std::move(text);
    spec.doc = std::move(doc);
    return spec;
}

std::string expected(const ParameterSpec& spec) {
    const std::string range = spec.range_text();
    return fmt::format("must be {}", range.empty() ? "finite" : range);
}

// A whole text as a number: "1e3", "12"; nothing else around it.
template <typename T>
bool parse_number(std::string_view text, T& value) {
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    return code == std::errc() && end == text.data() + text.size();
}

// The index of a choice's name; the number of names if there is no such name.
size_t index_of(const ParameterSpec& spec, std::string_view name) {
    return size_t(std::find(spec.choices.begin(), spec.choices.end(), name) - spec.choices.begin());
}

void store(void* target, const ParameterField& field, double value) {
    char* place = static_cast<char*>(target) + field.offset;
    const auto write = [&](auto number) { std::memcpy(place, &number, sizeof number); };
    switch (field.type) {
        case ParameterField::Type::kInt: write(int32_t(value)); break;
        case ParameterField::Type::kUint: write(uint32_t(value)); break;
        case ParameterField::Type::kFloat: write(float(value)); break;
    }
}

}  // namespace

ParameterSpec real(std::string name, double default_value, std::string doc) {
    return make_spec(std::move(name), ParameterType::kFloat, default_value, {}, std::move(doc));
}
ParameterSpec integer(std::string name, int default_value, std::string doc) {
    return make_spec(std::move(name), ParameterType::kInteger, default_value, {}, std::move(doc));
}
ParameterSpec boolean(std::string name, bool default_value, std::string doc) {
    return make_spec(std::move(name), ParameterType::kBool, default_value ? 1.0 : 0.0, {}, std::move(doc));
}
ParameterSpec text(std::string name, std::string default_value, std::string doc) {
    return make_spec(std::move(name), ParameterType::kString, 0.0, std::move(default_value), std::move(doc));
}
ParameterSpec choice(std::string name, size_t default_index, std::string_view doc) {
    std::vector<std::string> names(1);
    size_t at = 1;
    for (; doc.at(at) != '}'; ++at) {
        if (doc[at] == '|') {
            names.emplace_back();
        } else {
            names.back() += doc[at];
        }
    }
    return text(std::move(name), names.at(default_index), std::string(doc.substr(at + 2))).one_of(names);
}
ParameterSpec value(std::string name, ParameterType type, std::string absent, std::string doc) {
    return make_spec(std::move(name), type, 0.0, std::move(absent), std::move(doc));
}
ParameterSpec values(std::string name, ParameterType type, std::string absent, std::string doc) {
    ParameterSpec spec = make_spec(std::move(name), type, 0.0, std::move(absent), std::move(doc));
    spec.array = true;
    return spec;
}

bool ParameterSpec::contains(double value) const {
    // Infinity is only allowed if it is the default, which means "no limit".
    if (!std::isfinite(value) && value != number) return false;
    return (above_minimum ? value > minimum : value >= minimum) && value <= maximum;
}

std::string ParameterSpec::type_text() const {
    std::string result = type == ParameterType::kSpectrum ? "rgb, blackbody or spectrum" : type_name(type);
    if (array) result += " array";
    if (!choices.empty()) result += ", one of " + list_of(choices);
    if (spectral) result += " or spectrum";
    if (texturable) result += " or texture";
    return result;
}

std::string ParameterSpec::number_text(double value) const {
    const bool whole = type == ParameterType::kInteger && std::isfinite(value);
    return whole ? fmt::format("{:.0f}", value) : fmt::format("{:g}", value);
}

std::string ParameterSpec::range_text() const {
    const bool low = std::isfinite(minimum), high = std::isfinite(maximum);
    if (low && high)
        return fmt::format("{}{} to {}", above_minimum ? "above " : "", number_text(minimum), number_text(maximum));
    if (low) return fmt::format("{} {}", above_minimum ? "above" : "at least", number_text(minimum));
    if (high) return fmt::format("at most {}", number_text(maximum));
    return {};
}

std::string ParameterSpec::default_text() const {
    if (required) return "(required)";
    const bool scalar = !array && text.empty();
    if (scalar && type == ParameterType::kBool) return number != 0.0 ? "true" : "false";
    if (scalar && (type == ParameterType::kFloat || type == ParameterType::kInteger)) return number_text(number);
    return text;
}

std::vector<std::string> spec_names(const ParameterSpecs& specs) {
    std::vector<std::string> names;
    for (const ParameterSpec& spec : specs) names.push_back(spec.name);
    return names;
}

const ParameterSpec* find_spec(const ParameterSpecs& specs, std::string_view name) {
    for (const ParameterSpec& spec : specs)
        if (spec.name == name) return &spec;
    return nullptr;
}

ParameterReader::ParameterReader(const ParameterSpecs& specs, Entity& entity, Diagnostics& diagnostics)
    : specs_(&specs), entity_(&entity), diagnostics_(&diagnostics) {
    const std::vector<std::string>& malformed = entity.parameters.malformed;
    for (const ParameterSpec& spec : specs)
        if (spec.required && !has(spec.name) &&
            std::find(malformed.begin(), malformed.end(), spec.name) == malformed.end())
            diagnostics.error(
                entity.location,
                fmt::format("\"{}\" needs the parameter \"{} {}\"", entity.type, type_name(spec.type), spec.name),
                spec.doc);
}

const ParameterSpec& ParameterReader::spec(std::string_view name) const {
    if (const ParameterSpec* found = find_spec(*specs_, name)) return *found;
    throw std::logic_error(fmt::format("no parameter \"{}\" is declared for \"{}\"", name, entity_->type));
}

bool ParameterReader::check(const ParameterSpec& spec, double value) {
    if (spec.contains(value)) return true;
    error(spec.name, fmt::format("\"{}\" is {}", spec.name, spec.number_text(value)), expected(spec));
    return false;
}

bool ParameterReader::has(std::string_view name) const { return entity_->parameters.has(name); }

float ParameterReader::get_float(std::string_view name) {
    const ParameterSpec& declared = spec(name);
    const float result = entity_->parameters.get_float(name, float(declared.number), *diagnostics_);
    return !has(name) || check(declared, result) ? result : float(declared.number);
}

int32_t ParameterReader::get_int(std::string_view name) {
    const ParameterSpec& declared = spec(name);
    const int32_t result = entity_->parameters.get_int(name, int32_t(declared.number), *diagnostics_);
    return !has(name) || check(declared, result) ? result : int32_t(declared.number);
}

bool ParameterReader::get_bool(std::string_view name) {
    return entity_->parameters.get_bool(name, spec(name).number != 0.0, *diagnostics_);
}

std::string ParameterReader::get_string(std::string_view name) {
    const ParameterSpec& declared = spec(name);
    if (const Parameter* given = find(name); declared.required && given && given->type == ParameterType::kString) {
        const auto* texts = std::get_if<std::vector<std::string>>(&given->values);
        if (texts && texts->size() == 1 && texts->front().empty())
            error(name, fmt::format("\"{}\" is empty", name), declared.doc);
    }
    return declared.choices.empty()
               ? entity_->parameters.get_string(name, declared.text, *diagnostics_)
               : entity_->parameters.get_choice(name, declared.text, declared.choices, *diagnostics_);
}

std::vector<float> ParameterReader::get_tuple(std::string_view name, size_t count) {
    std::vector<float> values = entity_->parameters.get_floats(name, spec(name).type, count, *diagnostics_);
    for (const float number : values)
        if (!std::isfinite(number)) {
            error(name, fmt::format("\"{}\" is not finite", name));
            return {};
        }
    return values;
}

std::vector<float> ParameterReader::take_floats(std::string_view name) {
    return entity_->parameters.take_floats(name, spec(name).type, *diagnostics_);
}

std::vector<int32_t> ParameterReader::take_ints(std::string_view name) {
    spec(name);
    return entity_->parameters.take_ints(name, *diagnostics_);
}

const Parameter* ParameterReader::find(std::string_view name) {
    spec(name);
    return entity_->parameters.find(name);
}

Location ParameterReader::location(std::string_view name) const {
    for (const Parameter& parameter : entity_->parameters.parameters)
        if (parameter.name == name)
            return parameter.value_location.known() ? parameter.value_location : parameter.location;
    return entity_->location;
}

void ParameterReader::error(std::string_view name, std::string message, std::string hint) {
    diagnostics_->error(location(name), std::move(message), std::move(hint));
}

void ParameterReader::warning(std::string_view name, std::string message, std::string hint) {
    diagnostics_->warning(location(name), std::move(message), std::move(hint));
}

void ParameterReader::finish(std::string_view kind) {
    if (entity_->parameters.all_used()) return;
    entity_->parameters.report_unused(fmt::format("{} \"{}\"", kind, entity_->type), spec_names(*specs_),
                                      *diagnostics_);
}

ParameterSpecs specs_of(const ParameterFields& fields) {
    ParameterSpecs specs;
    for (const ParameterField& field : fields) specs.push_back(field.spec);
    return specs;
}

void set_defaults(void* target, const ParameterFields& fields) {
    for (const ParameterField& field : fields)
        store(target, field,
              field.spec.choices.empty() ? field.spec.number : double(index_of(field.spec, field.spec.text)));
}

void read_parameters(void* target, const ParameterFields& fields, const ParameterList& list, Diagnostics& diagnostics) {
    for (const ParameterField& field : fields) {
        const ParameterSpec& spec = field.spec;
        if (!list.has(spec.name)) continue;
        if (!spec.choices.empty()) {
            store(target, field,
                  double(index_of(spec, list.get_choice(spec.name, spec.text, spec.choices, diagnostics))));
            continue;
        }
        const double value = field.type == ParameterField::Type::kFloat
                                 ? double(list.get_float(spec.name, float(spec.number), diagnostics))
                                 : double(list.get_int(spec.name, int32_t(spec.number), diagnostics));
        if (spec.contains(value)) {
            store(target, field, value);
        } else {
            diagnostics.error(list.find(spec.name)->value_location,
                              fmt::format("\"{}\" is {}", spec.name, spec.number_text(value)), expected(spec));
        }
    }
}

void set_parameter(void* target, const ParameterFields& fields, std::string_view key, std::string_view value,
                   const std::string& of_what) {
    const ParameterField* field = nullptr;
    for (const ParameterField& candidate : fields)
        if (candidate.spec.name == key) field = &candidate;
    if (!field) {
        const std::vector<std::string> names = spec_names(specs_of(fields));
        throw InputError(fmt::format("error: {} has no parameter \"{}\"{}; it has: {}", of_what, key,
                                     did_you_mean(key, names), names.empty() ? "none" : list_of(names)));
    }
    if (!field->spec.choices.empty()) {
        const size_t index = index_of(field->spec, value);
        if (index == field->spec.choices.size())
            throw InputError(fmt::format("error: {}: \"{}\" is {}{}; valid are {}", of_what, key, shown(value),
                                         did_you_mean(value, field->spec.choices), list_of(field->spec.choices)));
        store(target, *field, double(index));
        return;
    }
    double number = 0.0;
    bool good;
    if (field->type == ParameterField::Type::kFloat) {
        good = parse_number(value, number);
    } else {
        int64_t whole = 0;
        good = parse_number(value, whole);
        number = double(whole);
    }
    // Bounds are rounded to the member's type: 0.1 is not below a bound of 0.1f.
    if (good && field->type == ParameterField::Type::kFloat) number = double(float(number));
    if (!good)
        throw InputError(fmt::format("error: {}: \"{}\" is not {} for \"{}\"", of_what, value,
                                     field->type == ParameterField::Type::kFloat ? "a number" : "a whole number", key));
    if (!field->spec.contains(number))
        throw InputError(fmt::format("error: {}: \"{}\" is {}; {}", of_what, key, value, expected(field->spec)));
    store(target, *field, number);
}

std::vector<std::pair<std::string, std::string>> show_parameters(const void* source, const ParameterFields& fields) {
    std::vector<std::pair<std::string, std::string>> shown;
    for (const ParameterField& field : fields) {
        const char* place = static_cast<const char*>(source) + field.offset;
        const auto read = [&](auto number) {
            std::memcpy(&number, place, sizeof number);
            return fmt::format("{}", number);
        };
        if (!field.spec.choices.empty()) {
            uint32_t index;
            std::memcpy(&index, place, sizeof index);
            shown.emplace_back(field.spec.name, field.spec.choices.at(index));
            continue;
        }
        shown.emplace_back(field.spec.name, field.type == ParameterField::Type::kInt    ? read(int32_t{})
                                            : field.type == ParameterField::Type::kUint ? read(uint32_t{})
                                                                                        : read(float{}));
    }
    return shown;
}

std::vector<std::pair<std::string, std::string>> parse_settings(std::string_view text) {
    std::vector<std::pair<std::string, std::string>> settings;
    while (!text.empty()) {
        const size_t comma = text.find(',');
        const std::string_view item = text.substr(0, comma);
        const size_t equals = item.find('=');
        if (equals == std::string_view::npos || equals == 0)
            throw InputError(fmt::format("error: \"{}\" is not of the form key=value", item));
        for (const auto& [key, value] : settings)
            if (key == item.substr(0, equals)) throw InputError(fmt::format("error: \"{}\" is set twice", key));
        settings.emplace_back(item.substr(0, equals), item.substr(equals + 1));
        if (comma == std::string_view::npos) break;
        text.remove_prefix(comma + 1);
    }
    return settings;
}

PluginChoice parse_plugin_choice(std::string_view text) {
    const size_t colon = text.find(':');
    PluginChoice choice{std::string(text.substr(0, colon)), {}};
    if (choice.name.empty())
        throw InputError(fmt::format("error: \"{}\" names no plugin; the form is NAME[:key=value,...]", text));
    if (colon != std::string_view::npos) choice.settings = parse_settings(text.substr(colon + 1));
    return choice;
}

}  // namespace lampyris

// Directives that come before WorldBegin, and those that hold for the whole scene.
#include "core/scene/number.h"
#include "core/scene/parser.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

namespace lampyris {

void Parser::world_begin(const Token& directive) {
    if (!blocks_.empty()) report_open_blocks(0);
    in_world_ = true;
    // pbrt resets the transforms only: media and colour space stay.
    state_.ctm = {glm::dmat4(1.0), glm::dmat4(1.0)};
    state_.active_times = GraphicsState::kBothTimes;
    define_coordinate_system("world", state_.ctm);
    (void)directive;
}

namespace {

enum class OptionType { kBool, kInteger, kFloat, kString };
struct OptionInfo {
    const char* name;
    OptionType type;
};
constexpr OptionInfo kOptions[] = {
    {"disablepixeljitter", OptionType::kBool},
    {"disabletexturefiltering", OptionType::kBool},
    {"disablewavelengthjitter", OptionType::kBool},
    {"displacementedgescale", OptionType::kFloat},
    {"forcediffuse", OptionType::kBool},
    {"msereferenceimage", OptionType::kString},
    {"msereferenceout", OptionType::kString},
    {"pixelstats", OptionType::kBool},
    {"rendercoordsys", OptionType::kString},
    {"seed", OptionType::kInteger},
    {"wavefront", OptionType::kBool},
};

// As pbrt compares them: "disable-pixel-jitter", "DisablePixelJitter" and "disablepixeljitter" are one.
std::string normalized(std::string_view name) {
    std::string result;
    for (char c : name)
        if (c != '_' && c != '-') result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

// False where the value is not of the type.
bool read_option(OptionType type, const Token& value, const std::string& text, Parameter& parameter) {
    const bool quoted = value.kind == TokenKind::kString;
    const char* begin = value.text.data();
    const char* end = begin + value.text.size();
    switch (type) {
        case OptionType::kBool:
            parameter.type = ParameterType::kBool;
            parameter.values = std::vector<uint8_t>{text == "true"};
            return text == "true" || text == "false";
        case OptionType::kInteger: {
            parameter.type = ParameterType::kInteger;
            int32_t number = 0;
            if (quoted || parse_int(begin, end, number).status != NumberStatus::kOk) return false;
            parameter.values = std::vector<int32_t>{number};
            return true;
        }
        case OptionType::kFloat: {
            parameter.type = ParameterType::kFloat;
            float number = 0.0f;
            if (quoted || parse_float(begin, end, number).status != NumberStatus::kOk) return false;
            parameter.values = std::vector<float>{number};
            return true;
        }
        case OptionType::kString:
            parameter.type = ParameterType::kString;
            parameter.values = std::vector<std::string>{text};
            return quoted;
    }
    return false;
}

}  // namespace

void Parser::option(const Token& directive) {
    std::string name;
    Location name_location;
    if (!read_string(directive, "an option's name", name, &name_location)) return;
    const Token value = tokenizer_->peek();
    if ((value.kind != TokenKind::kWord && value.kind != TokenKind::kString) ||
        (value.kind == TokenKind::kWord && is_directive(value.text))) {
        diagnostics_->error(name_location, "option \"" + shown(name) + "\" has no value");
        return skip_to_directive();
    }
    tokenizer_->next();
    Parameter parameter{};
    parameter.name = normalized(name);
    parameter.location = name_location;
    parameter.value_location = value.location;
    const auto* info = std::find_if(std::begin(kOptions), std::end(kOptions),
                                    [&](const OptionInfo& known) { return parameter.name == known.name; });
    if (info == std::end(kOptions)) {
        std::vector<std::string> names;
        for (const OptionInfo& known : kOptions) names.emplace_back(known.name);
        diagnostics_->error(name_location,
                            "unknown option \"" + shown(name) + "\"" + did_you_mean(parameter.name, names),
                            "options are " + list_of(names));
        return;
    }
    if (!read_option(info->type, value, tokenizer_->string_value(value), parameter)) {
        static constexpr const char* kExpected[] = {"true or false", "an integer", "a number", "a string in quotes"};
        diagnostics_->error(value.location,
                            "option \"" + shown(name) + "\" takes " + kExpected[static_cast<int>(info->type)]);
        return;
    }
    // The last directive wins, as in pbrt.
    std::erase_if(scene_.options.parameters, [&](const Parameter& other) { return other.name == parameter.name; });
    scene_.options.parameters.push_back(std::move(parameter));
}

void Parser::color_space(const Token& directive) {
    std::string name;
    Location location;
    if (!read_string(directive, "a colour space's name", name, &location)) return;
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    const auto known = std::find(kColorSpaces.begin(), kColorSpaces.end(), name);
    if (known == kColorSpaces.end()) {
        const std::vector<std::string> names(kColorSpaces.begin(), kColorSpaces.end());
        diagnostics_->error(location, "unknown colour space \"" + shown(name) + "\"" + did_you_mean(name, names),
                            "colour spaces are " + list_of(names));
        return;
    }
    state_.color_space = *known;
}

void Parser::set_once(const Token& directive, Entity& entity) {
    Entity read;
    if (!read_entity(directive, read)) return;
    if (entity.given())
        diagnostics_->warning(directive.location,
                              std::string(directive.text) + " is given a second time; this one is used");
    entity = std::move(read);
}

void Parser::camera(const Token& directive) {
    set_once(directive, scene_.camera);
    std::array<glm::dmat4, 2> world_from_camera;
    for (int i = 0; i < 2; ++i) {
        const double determinant = glm::determinant(state_.ctm[i]);
        if (determinant == 0.0 || !std::isfinite(determinant)) {
            diagnostics_->error(directive.location,
                                "the transform in force here cannot be inverted: the camera sees nothing",
                                "look for a Scale with a zero or a degenerate Transform before this line");
            return;
        }
        world_from_camera[i] = glm::inverse(state_.ctm[i]);
        scene_.camera.world_from_camera.matrix[i] = glm::mat4(world_from_camera[i]);
    }
    places_.camera = glm::dvec3(world_from_camera[0][3]);
    define_coordinate_system("camera", world_from_camera);
    scene_.camera.medium = state_.exterior_medium;
}

void Parser::film(const Token& directive) {
    set_once(directive, scene_.film);
    scene_.color_space = state_.color_space;
}

void Parser::sampler(const Token& directive) { set_once(directive, scene_.sampler); }
void Parser::pixel_filter(const Token& directive) { set_once(directive, scene_.pixel_filter); }
void Parser::integrator(const Token& directive) { set_once(directive, scene_.integrator); }
void Parser::accelerator(const Token& directive) { set_once(directive, scene_.accelerator); }

void Parser::include(const Token& directive) {
    std::string name, path;
    Location location;
    if (read_string(directive, "a file name", name, &location)) open_file(directive, name, location, path);
}

// Like Include, but the file's changes to the graphics state, and the blocks it opens, end with the file.
void Parser::import(const Token& directive) {
    std::string name, path;
    Location location;
    if (!read_string(directive, "a file name", name, &location)) return;
    const GraphicsState saved = state_;
    const uint32_t object = object_;
    const size_t undo_from = undo_.size();
    const bool outer_importing = std::exchange(importing_, true);
    const size_t outer_first_block = std::exchange(first_own_block_, blocks_.size());
    open_file(directive, name, location, path);
    report_open_blocks(first_own_block_);
    blocks_.resize(std::min(blocks_.size(), first_own_block_));
    first_own_block_ = outer_first_block;
    object_ = object;
    importing_ = outer_importing;
    for (; undo_.size() > undo_from; undo_.pop_back()) {
        auto& [changed, before] = undo_.back();
        if (before)
            coordinate_systems_[changed] = *before;
        else
            coordinate_systems_.erase(changed);
    }
    state_ = saved;
}

}  // namespace lampyris

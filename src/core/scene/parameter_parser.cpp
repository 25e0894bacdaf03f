#include "core/scene/parameter_parser.h"

#include "core/scene/number.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

namespace lampyris {
namespace {

// Names from older versions or other formats: either accepted with a warning, or only suggested.
struct Alias {
    std::string_view alias;
    const char* name;
    bool accepted;
};
constexpr Alias kAliases[] = {
    {"point", "point3", true},    {"vector", "vector3", true}, {"color", "rgb", true},
    {"int", "integer", false},    {"boolean", "bool", false},  {"double", "float", false},
    {"normal3", "normal", false}, {"vec3", "vector3", false},  {"str", "string", false},
};

const ParameterTypeInfo* find_type(std::string_view name) {
    for (const ParameterTypeInfo& info : kParameterTypes)
        if (name == info.name) return &info;
    return nullptr;
}

std::vector<std::string> type_names() {
    std::vector<std::string> names;
    for (const ParameterTypeInfo& info : kParameterTypes) names.push_back(info.name);
    return names;
}

std::vector<std::string_view> split(std::string_view text) {
    std::vector<std::string_view> words;
    while (true) {
        const size_t start = text.find_first_not_of(" \t\r");
        if (start == std::string_view::npos) return words;
        const size_t stop = std::min(text.find_first_of(" \t\r", start), text.size());
        words.push_back(text.substr(start, stop - start));
        text.remove_prefix(stop);
    }
}

// "type name", as opposed to a string value: it shows that an array was never closed.
bool looks_like_declaration(const Token& token) {
    if (token.kind != TokenKind::kString || token.text.size() > 100) return false;
    const auto words = split(token.text);
    return words.size() == 2 && find_type(words[0]);
}

bool is_number(std::string_view text) {
    double value;
    return parse_double(text.data(), text.data() + text.size(), value).status == NumberStatus::kOk;
}

NumberResult parse_number(const char* p, const char* end, float& value) { return parse_float(p, end, value); }
NumberResult parse_number(const char* p, const char* end, int32_t& value) { return parse_int(p, end, value); }

std::string quoted(const Parameter& parameter) {
    return std::string("\"") + type_name(parameter.type) + " " + shown(parameter.name) + "\"";
}

template <typename T>
std::vector<T> hand_over(std::vector<T>& scratch) {
    constexpr size_t kSmall = 4096;
    if (scratch.size() > kSmall) return std::exchange(scratch, {});
    return std::vector<T>(scratch.begin(), scratch.end());
}

}  // namespace

void ParameterParser::parse(Tokenizer& tokenizer, std::string_view color_space, ParameterList& list) {
    std::vector<Parameter>& parameters = list.parameters;
    std::unordered_set<std::string> names;
    while (tokenizer.peek().kind == TokenKind::kString) {
        const Token declaration = tokenizer.next();
        Parameter parameter{};
        parameter.color_space = color_space;
        if (!parse_declaration(tokenizer, declaration, parameter)) {
            skip_values(tokenizer);
            continue;
        }
        old_format_->parameter_name(parameter.name, parameter.location);
        if (!parse_values(tokenizer, parameter)) {
            list.malformed.push_back(parameter.name);
            continue;
        }
        constexpr size_t kFew = 16;  // below this, a linear search is cheaper than a set
        bool duplicate = false;
        if (parameters.size() < kFew) {
            for (const Parameter& other : parameters) duplicate = duplicate || other.name == parameter.name;
        } else {
            if (names.empty())
                for (const Parameter& other : parameters) names.insert(other.name);
            duplicate = !names.insert(parameter.name).second;
        }
        if (duplicate)
            diagnostics_->error(parameter.location, "parameter \"" + shown(parameter.name) + "\" is given twice",
                                "leave one of the two");
        else
            parameters.push_back(std::move(parameter));
        tokenizer.release_consumed();
    }
}

bool ParameterParser::parse_declaration(Tokenizer& tokenizer, const Token& token, Parameter& parameter) {
    parameter.location = token.location;
    const std::string text = tokenizer.string_value(token);
    const auto words = split(text);
    const std::string example = "a parameter is \"type name\" and then its value, as in \"float radius\" 2";
    if (words.size() != 2) {
        std::string message;
        if (words.empty())
            message = "an empty string where a parameter should be";
        else if (words.size() > 2)
            message = "\"" + shown(text) + "\" is no parameter: it has more than a type and a name";
        else if (find_type(words[0]))
            message = "this parameter has a type (" + std::string(words[0]) + ") but no name";
        else
            message = "\"" + shown(text) + "\" is no parameter: it has no type";
        diagnostics_->error(token.location, message, example);
        return false;
    }
    parameter.name = words[1];
    const ParameterTypeInfo* info = find_type(words[0]);
    if (!info) {
        for (const Alias& alias : kAliases) {
            if (words[0] != alias.alias) continue;
            info = find_type(alias.name);
            if (old_format_->parameter_type(words[0], token.location)) break;
            const std::string now = std::string("it is called \"") + alias.name + "\" in pbrt-v4";
            if (alias.accepted)
                diagnostics_->warning(token.location, "type \"" + shown(words[0]) + "\" is an old name", now);
            else
                diagnostics_->error(token.location, "unknown parameter type \"" + shown(words[0]) + "\"", now);
            break;
        }
    }
    if (!info) {
        if (!old_format_->parameter_type(words[0], token.location))
            diagnostics_->error(
                token.location,
                "unknown parameter type \"" + shown(words[0]) + "\"" + did_you_mean(words[0], type_names()),
                "types are " + list_of(type_names()));
        return false;
    }
    parameter.type = info->type;
    return true;
}

bool ParameterParser::missing_value(const Parameter& parameter, const Token& found) {
    std::string what = found.kind == TokenKind::kEnd ? "the file ends" : "\"" + shown(found.text) + "\" follows";
    diagnostics_->error(parameter.location, "parameter " + quoted(parameter) + " has no value: " + what);
    return false;
}

void ParameterParser::wrong_value(const Parameter& parameter, const Token& token, const char* expected) {
    const bool comma = token.kind == TokenKind::kWord && token.text.find(',') != std::string_view::npos;
    const std::string found =
        token.kind == TokenKind::kString ? "the string \"" + shown(token.text) + "\"" : "\"" + shown(token.text) + "\"";
    diagnostics_->error(token.location,
                        std::string("expected ") + expected + " for " + quoted(parameter) + ", found " + found,
                        comma ? "blanks separate values, not commas" : "");
}

bool ParameterParser::ends_unclosed(Tokenizer& tokenizer, const Parameter& parameter, Location open) {
    const Token& token = tokenizer.peek();
    const bool end = token.kind == TokenKind::kEnd;
    // A string value may well look like a declaration.
    const bool declaration = parameter.type != ParameterType::kString && looks_like_declaration(token);
    if (!end && !declaration && !(token.kind == TokenKind::kWord && is_directive(token.text))) return false;
    std::string where = end ? "the file ends first" : "\"" + shown(token.text) + "\" follows";
    if (!end && !diagnostics_->full())
        where += " at line " + std::to_string(diagnostics_->sources().place(token.location).line);
    diagnostics_->error(open, "this '[' of " + quoted(parameter) + " is never closed: " + where, "close it with ']'");
    return true;
}

bool ParameterParser::parse_values(Tokenizer& tokenizer, Parameter& parameter) {
    const char* first = tokenizer.cursor();
    if (first != tokenizer.end() && *first == '[') first = Tokenizer::skip_blank(first + 1, tokenizer.end());
    parameter.value_location = tokenizer.location(first);
    bool numeric = parameter.type != ParameterType::kString && parameter.type != ParameterType::kTexture &&
                   parameter.type != ParameterType::kBool;
    if (parameter.type == ParameterType::kSpectrum) {
        // Numbers or names: the first value decides which.
        numeric = first != tokenizer.end() && *first != '"';
    }
    bool good;
    if (!numeric) {
        good = parse_words(tokenizer, parameter);
    } else if (parameter.type == ParameterType::kInteger) {
        ints_.clear();
        good = parse_numbers(tokenizer, parameter, ints_);
        if (good) parameter.values = hand_over(ints_);
    } else {
        floats_.clear();
        good = parse_numbers(tokenizer, parameter, floats_);
        if (good) parameter.values = hand_over(floats_);
    }
    return good && check_count(parameter);
}

template <typename T>
bool ParameterParser::parse_numbers(Tokenizer& tokenizer, const Parameter& parameter, std::vector<T>& values) {
    constexpr size_t kReleaseEvery = size_t(1) << 20;  // numbers
    const char* expected = std::is_same_v<T, float> ? "a number" : "an integer";
    const char* p = tokenizer.cursor();
    const char* end = tokenizer.end();
    const bool bracketed = p != end && *p == '[';
    const Location open = tokenizer.location(p);
    if (bracketed) ++p;
    bool good = true;
    while (true) {
        p = Tokenizer::skip_blank(p, end);
        T value{};
        if (p != end && *p == ']') {
            if (bracketed) {
                ++p;
                break;
            }
        } else if (p != end) {
            const NumberResult result = parse_number(p, end, value);
            if (result.status == NumberStatus::kOk) {
                values.push_back(value);
                p = result.end;
                if (!bracketed) break;
                if (values.size() % kReleaseEvery == 0) {
                    tokenizer.set_cursor(p);
                    tokenizer.release_consumed();
                }
                continue;
            }
            if (result.status == NumberStatus::kOutOfRange) {
                if (good)
                    diagnostics_->error(tokenizer.location(p),
                                        "number out of range for a 32-bit " +
                                            std::string(std::is_same_v<T, float> ? "float" : "integer"));
                good = false;
                p = result.end;
                if (!bracketed) break;
                continue;
            }
        }
        // Not a number: report it.
        tokenizer.set_cursor(p);
        if (bracketed && ends_unclosed(tokenizer, parameter, open)) return false;
        const Token token = tokenizer.peek();
        if (!bracketed &&
            (token.kind == TokenKind::kEnd || token.kind == TokenKind::kClose || looks_like_declaration(token) ||
             (token.kind == TokenKind::kWord && is_directive(token.text))))
            return missing_value(parameter, token);
        if (good) wrong_value(parameter, token, expected);
        good = false;
        tokenizer.next();
        p = tokenizer.cursor();
        if (!bracketed) break;
    }
    tokenizer.set_cursor(p);
    if (!bracketed && tokenizer.peek().kind == TokenKind::kWord && is_number(tokenizer.peek().text)) {
        if (good)
            diagnostics_->error(tokenizer.peek().location, "several values of " + quoted(parameter) + " need brackets",
                                "write " + quoted(parameter) + " [ ... ]");
        good = false;
        skip_values(tokenizer);
    }
    return good;
}

bool ParameterParser::parse_words(Tokenizer& tokenizer, Parameter& parameter) {
    if (parameter.type == ParameterType::kBool)
        parameter.values = std::vector<uint8_t>();
    else
        parameter.values = std::vector<std::string>();
    if (tokenizer.peek().kind != TokenKind::kOpen) {
        const Token token = tokenizer.peek();
        if (token.kind == TokenKind::kEnd || token.kind == TokenKind::kClose ||
            (token.kind == TokenKind::kWord && is_directive(token.text)))
            return missing_value(parameter, token);
        tokenizer.next();
        return parse_word(tokenizer, token, parameter);
    }
    const Location open = tokenizer.next().location;
    bool good = true;
    while (tokenizer.peek().kind != TokenKind::kClose) {
        if (ends_unclosed(tokenizer, parameter, open)) return false;
        const Token token = tokenizer.next();
        if (good) good = parse_word(tokenizer, token, parameter);
    }
    tokenizer.next();
    return good;
}

bool ParameterParser::parse_word(Tokenizer& tokenizer, const Token& token, Parameter& parameter) {
    if (auto* bools = std::get_if<std::vector<uint8_t>>(&parameter.values)) {
        // The quoted form is pbrt-v3's; some of pbrt-v4's files still have it.
        if ((token.kind != TokenKind::kWord && token.kind != TokenKind::kString) ||
            (token.text != "true" && token.text != "false")) {
            wrong_value(parameter, token, "true or false");
            return false;
        }
        bools->push_back(token.text == "true");
        return true;
    }
    if (token.kind != TokenKind::kString) {
        wrong_value(parameter, token,
                    parameter.type == ParameterType::kTexture ? "a texture's name in quotes" : "a string in quotes");
        return false;
    }
    std::get<std::vector<std::string>>(parameter.values).push_back(tokenizer.string_value(token));
    return true;
}

bool ParameterParser::check_count(const Parameter& parameter) {
    const auto* floats = std::get_if<std::vector<float>>(&parameter.values);
    const ParameterTypeInfo& info = type_info(parameter.type);
    if (!floats) return true;
    if (floats->size() % info.tuple != 0) {
        diagnostics_->error(
            parameter.location,
            "parameter " + quoted(parameter) + " has " + std::to_string(floats->size()) + " numbers",
            parameter.type == ParameterType::kSpectrum
                ? "a spectrum is pairs of wavelength (nm) and value"
                : "type " + std::string(info.name) + " takes a multiple of " + std::to_string(info.tuple));
        return false;
    }
    if (parameter.type == ParameterType::kSpectrum) {
        for (size_t i = 2; i < floats->size(); i += 2) {
            if ((*floats)[i] > (*floats)[i - 2]) continue;
            diagnostics_->error(parameter.location, "the wavelengths of " + quoted(parameter) +
                                                        " do not increase at pair " + std::to_string(i / 2 + 1));
            return false;
        }
    }
    return true;
}

// Skips the values of a parameter that was not understood.
void ParameterParser::skip_values(Tokenizer& tokenizer) {
    if (tokenizer.peek().kind == TokenKind::kOpen) {
        while (tokenizer.peek().kind != TokenKind::kEnd) {
            const Token token = tokenizer.peek();
            if (token.kind == TokenKind::kWord && is_directive(token.text)) return;
            tokenizer.next();
            if (token.kind == TokenKind::kClose) return;
        }
    } else if (tokenizer.peek().kind == TokenKind::kString) {
        if (!looks_like_declaration(tokenizer.peek())) tokenizer.next();
    } else {
        while (tokenizer.peek().kind == TokenKind::kWord && !is_directive(tokenizer.peek().text)) tokenizer.next();
    }
}

}  // namespace lampyris

// Directives that change the current transform. Each multiplies from the right: the last one written is applied first.
#include "core/scene/number.h"
#include "core/scene/parser.h"

#include <cmath>
#include <numbers>

namespace lampyris {

// `count` numbers, in brackets or without.
bool Parser::read_numbers(const Token& directive, std::span<double> values, bool bracketed) {
    const std::string name(directive.text);
    const std::string needs =
        name + " takes " + std::to_string(values.size()) + " numbers" + (bracketed ? " in brackets" : "");
    const auto fail = [&](const Token& token, const std::string& what) {
        diagnostics_->error(token.kind == TokenKind::kEnd ? directive.location : token.location, what, needs);
        skip_to_directive();
        return false;
    };
    const auto describe = [](const Token& token) {
        return token.kind == TokenKind::kEnd ? std::string("the file ends") : "found \"" + shown(token.text) + "\"";
    };
    if (bracketed) {
        if (tokenizer_->peek().kind != TokenKind::kOpen)
            return fail(tokenizer_->peek(), "expected '[', but " + describe(tokenizer_->peek()));
        tokenizer_->next();
    }
    for (size_t i = 0; i < values.size(); ++i) {
        const Token token = tokenizer_->peek();
        const char* end = token.text.data() + token.text.size();
        const auto result = token.kind == TokenKind::kWord ? parse_double(token.text.data(), end, values[i])
                                                           : NumberResult{end, NumberStatus::kNotANumber};
        if (result.status == NumberStatus::kNotANumber)
            return fail(token, "expected number " + std::to_string(i + 1) + " of " + std::to_string(values.size()) +
                                   ", but " + describe(token));
        constexpr double kMaxFloat = 3.4e38;  // matrices become floats
        if (result.status == NumberStatus::kOutOfRange || std::abs(values[i]) > kMaxFloat)
            return fail(token, "number out of range for a 32-bit float");
        tokenizer_->next();
    }
    if (bracketed) {
        if (tokenizer_->peek().kind != TokenKind::kClose)
            return fail(tokenizer_->peek(), "expected ']', but " + describe(tokenizer_->peek()));
        tokenizer_->next();
    }
    return true;
}

void Parser::apply(const glm::dmat4& matrix, bool replace) {
    for (int i = 0; i < 2; ++i)
        if (state_.active_times & (1u << i)) state_.ctm[i] = replace ? matrix : state_.ctm[i] * matrix;
}

void Parser::identity(const Token&) { apply(glm::dmat4(1.0), true); }

void Parser::translate(const Token& directive) {
    std::array<double, 3> v;
    if (!read_numbers(directive, v, false)) return;
    glm::dmat4 matrix(1.0);
    matrix[3] = glm::dvec4(v[0], v[1], v[2], 1.0);
    apply(matrix);
}

void Parser::scale(const Token& directive) {
    std::array<double, 3> v;
    if (!read_numbers(directive, v, false)) return;
    glm::dmat4 matrix(1.0);
    for (int i = 0; i < 3; ++i) matrix[i][i] = v[i];
    apply(matrix);
}

// Rotate angle x y z: degrees, about an axis through the origin (Rodrigues' formula).
void Parser::rotate(const Token& directive) {
    std::array<double, 4> v;
    if (!read_numbers(directive, v, false)) return;
    const double length = std::sqrt(v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
    if (length == 0.0) return diagnostics_->error(directive.location, "Rotate's axis is the zero vector");
    const double x = v[1] / length, y = v[2] / length, z = v[3] / length;
    const double angle = v[0] * std::numbers::pi / 180.0;
    const double c = std::cos(angle), s = std::sin(angle), t = 1.0 - c;
    glm::dmat4 matrix(1.0);  // by columns
    matrix[0] = glm::dvec4(x * x * t + c, x * y * t + z * s, x * z * t - y * s, 0.0);
    matrix[1] = glm::dvec4(x * y * t - z * s, y * y * t + c, y * z * t + x * s, 0.0);
    matrix[2] = glm::dvec4(x * z * t + y * s, y * z * t - x * s, z * z * t + c, 0.0);
    apply(matrix);
}

// LookAt eye target up: pbrt's camera space is left-handed, with x to the right (up cross direction), y up and z forward.
void Parser::look_at(const Token& directive) {
    std::array<double, 9> v;
    if (!read_numbers(directive, v, false)) return;
    const glm::dvec3 eye(v[0], v[1], v[2]), target(v[3], v[4], v[5]), up(v[6], v[7], v[8]);
    const auto length = [](const glm::dvec3& a) { return std::sqrt(glm::dot(a, a)); };
    if (length(target - eye) == 0.0)
        return diagnostics_->error(directive.location, "LookAt's eye and target are the same point");
    if (length(up) == 0.0) return diagnostics_->error(directive.location, "LookAt's up vector is the zero vector");
    const glm::dvec3 direction = (target - eye) / length(target - eye);
    glm::dvec3 right = glm::cross(up / length(up), direction);
    if (length(right) == 0.0)
        return diagnostics_->error(directive.location, "LookAt's up vector is parallel to its viewing direction");
    right /= length(right);
    const glm::dvec3 camera_up = glm::cross(direction, right);
    glm::dmat4 world_from_camera(1.0);
    world_from_camera[0] = glm::dvec4(right, 0.0);
    world_from_camera[1] = glm::dvec4(camera_up, 0.0);
    world_from_camera[2] = glm::dvec4(direction, 0.0);
    world_from_camera[3] = glm::dvec4(eye, 1.0);
    apply(glm::inverse(world_from_camera));
}

namespace {

// The text gives a matrix column by column, which is also how GLM keeps it.
glm::dmat4 matrix_of(const std::array<double, 16>& v) {
    glm::dmat4 matrix;
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = v[static_cast<size_t>(i)];
    return matrix;
}

}  // namespace

void Parser::transform(const Token& directive) {
    std::array<double, 16> v;
    if (read_numbers(directive, v, true)) apply(matrix_of(v), true);
}

void Parser::concat_transform(const Token& directive) {
    std::array<double, 16> v;
    if (read_numbers(directive, v, true)) apply(matrix_of(v));
}

void Parser::coordinate_system(const Token& directive) {
    std::string name;
    if (read_string(directive, "a name", name)) define_coordinate_system(name, state_.ctm);
}

void Parser::define_coordinate_system(const std::string& name, const CoordinateSystem& matrices) {
    const auto [place, is_new] = coordinate_systems_.try_emplace(name, matrices);
    if (importing_) undo_.emplace_back(name, is_new ? std::nullopt : std::optional(place->second));
    place->second = matrices;
}

void Parser::coord_sys_transform(const Token& directive) {
    std::string name;
    Location location;
    if (!read_string(directive, "a coordinate system's name", name, &location)) return;
    const auto known = coordinate_systems_.find(name);
    if (known != coordinate_systems_.end()) {
        state_.ctm = known->second;  // at both times, whatever ActiveTransform says, as in pbrt
        return;
    }
    const auto names = [&] {
        std::vector<std::string> all;
        for (const auto& [known_name, matrices] : coordinate_systems_) all.push_back(known_name);
        return all;
    };
    diagnostics_->error(location,
                        "no coordinate system is named \"" + shown(name) + "\"" + diagnostics_->guess(name, names),
                        name == "camera" ? "\"camera\" is defined by the Camera directive" : "");
}

void Parser::active_transform(const Token& directive) {
    const Token token = tokenizer_->peek();
    if (token.text == "StartTime") {
        state_.active_times = 1;
    } else if (token.text == "EndTime") {
        state_.active_times = 2;
    } else if (token.text == "All") {
        state_.active_times = GraphicsState::kBothTimes;
    } else {
        const bool end = token.kind == TokenKind::kEnd;
        diagnostics_->error(end ? directive.location : token.location,
                            end ? "ActiveTransform lacks its time" : "unknown time \"" + shown(token.text) + "\"",
                            "write ActiveTransform StartTime, EndTime or All");
        return skip_to_directive();
    }
    tokenizer_->next();
}

void Parser::transform_times(const Token& directive) {
    std::array<double, 2> v;
    if (!read_numbers(directive, v, false)) return;
    if (v[1] < v[0])
        return diagnostics_->error(directive.location, "TransformTimes ends before it starts",
                                   "write TransformTimes start end");
    scene_.transform_start_time = static_cast<float>(v[0]);
    scene_.transform_end_time = static_cast<float>(v[1]);
}

}  // namespace lampyris

#include "core/scene/light_bounds.h"

#include "core/scene/quadric_box.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace lampyris {
namespace {

constexpr double kPi = std::numbers::pi;

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

struct Cone {
    glm::dvec3 axis;
    double angle;
};

// The smallest cone that contains both.
Cone joined_cone(const Cone& a, const Cone& b) {
    if (a.angle < b.angle) return joined_cone(b, a);
    if (a.angle >= kPi) return a;  // of points: the most, and angles take time
    const double between = angle_between(a.axis, b.axis);
    if (std::min(between + b.angle, kPi) <= a.angle) return a;
    const double angle = 0.5 * (a.angle + between + b.angle);
    const glm::dvec3 around = glm::cross(a.axis, b.axis);
    const double sine = glm::length(around);
    if (angle >= kPi || !(sine > 0)) return {a.axis, kPi};
    // The axis turned from a's towards b's.
    const double turn = angle - a.angle;
    const glm::dvec3 beside = glm::cross(around / sine, a.axis);
    return {glm::normalize(std::cos(turn) * a.axis + std::sin(turn) * beside), angle};
}

// Normals may point anywhere.
void set_all_directions(LightBounds& bounds) { bounds.normals = kPi, bounds.emission = 0.5 * kPi; }

glm::dvec3 corner_of(const Scene& scene, const kernel::GeometryRecord& g, uint32_t corner) {
    const size_t v = size_t(g.first_vertex) + scene.indices[g.first_index + corner];
    return {scene.positions[3 * v], scene.positions[3 * v + 1], scene.positions[3 * v + 2]};
}

// Patches are two-sided here: which side emits may differ from point to point.
void add_patch(LightBounds& bounds, const Scene& scene, const kernel::GeometryRecord& g, uint32_t primitive) {
    std::array<glm::dvec3, 4> p;
    for (uint32_t i = 0; i < 4; ++i) bounds.add(p[i] = corner_of(scene, g, 4 * primitive + i));
    bounds.two_sided = true, bounds.emission = 0.5 * kPi;
    std::optional<Cone> cone;
    const auto& [p00, p10, p01, p11] = p;
    const std::array<std::array<glm::dvec3, 2>, 4> edges = {
        {{p10 - p00, p01 - p00}, {p10 - p00, p11 - p10}, {p11 - p01, p01 - p00}, {p11 - p01, p11 - p10}}};
    for (const auto& [u, v] : edges) {
        const glm::dvec3 normal = glm::cross(u, v);
        const double length = glm::length(normal);
        if (!(length > 0)) return set_all_directions(bounds);
        const Cone one{normal / length, 0};
        cone = cone ? joined_cone(*cone, one) : one;
    }
    // Normals between the corners are combinations of theirs, in a convex cone if it is narrower than a half space.
    if (cone->angle >= 0.5 * kPi) return set_all_directions(bounds);
    bounds.axis = cone->axis, bounds.normals = cone->angle;
}

void add_quadric(LightBounds& bounds, const Scene& scene, const kernel::GeometryRecord& g) {
    for (const glm::dvec3& p : quadric_corners(scene, g)) bounds.add(p);
    set_all_directions(bounds);
    if (g.kind != kernel::GEOMETRY_DISK) return;
    const kernel::TransformRecord& t = scene.transforms[g.transform];
    const glm::dvec3 normal(t.from2.x, t.from2.y, t.from2.z);  // of a plane of equal z
    if (!(glm::length(normal) > 0)) return;
    bounds.axis = glm::normalize(normal), bounds.normals = 0, bounds.two_sided = true;
}

// The half angle and solid angle of a projection light's picture.
std::array<double, 2> picture_angles(const kernel::LightRecord& light) {
    const double x = light.p2.z, y = light.inverse_area;  // set_projection_window: the picture's middle is on the axis
    return {std::atan(std::hypot(x, y)), 4 * std::atan(x * y / std::sqrt(1 + x * x + y * y))};
}

}  // namespace

void LightBounds::add(const glm::dvec3& p) { low = glm::min(low, p), high = glm::max(high, p); }

LightBounds joined(const LightBounds& a, const LightBounds& b) {
    if (!(a.intensity > 0)) return b;
    if (!(b.intensity > 0)) return a;
    LightBounds both;
    both.low = glm::min(a.low, b.low), both.high = glm::max(a.high, b.high);
    const Cone cone = joined_cone({a.axis, a.normals}, {b.axis, b.normals});
    both.axis = cone.axis, both.normals = cone.angle;
    both.emission = std::max(a.emission, b.emission);
    both.two_sided = a.two_sided || b.two_sided;
    both.intensity = a.intensity + b.intensity;
    return both;
}

double tree_cost(const LightBounds& bounds) {
    if (!(bounds.intensity > 0)) return 0;
    const double o = bounds.normals, w = std::min(o + bounds.emission, kPi);
    const double directions =
        o >= kPi ? 4 * kPi
                 : 2 * kPi * (1 - std::cos(o)) +
                       0.5 * kPi * (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o));
    const glm::dvec3 diagonal = bounds.high - bounds.low;
    return bounds.intensity * directions * glm::dot(diagonal, diagonal);
}

static LightBounds known_bounds(const Scene& scene, const kernel::LightRecord& light, double power) {
    LightBounds bounds;
    const double sides = (light.flags & kernel::LIGHT_TWO_SIDED) != 0u ? 2 : 1;
    if (light.kind <= kernel::LIGHT_GEOMETRY) {
        bounds.intensity = power / (kPi * sides);
        bounds.two_sided = sides == 2;
        if (light.kind == kernel::LIGHT_TRIANGLE) {
            for (const auto& p : {light.p0, light.p1, light.p2}) bounds.add(glm::dvec3(p));
            bounds.axis = glm::dvec3(light.normal), bounds.emission = 0.5 * kPi;
            if (light.smooth_normals != 0.0f) bounds.two_sided = true;  // they decide which side emits
        } else if (const auto& g = scene.geometries[light.geometry]; g.kind == kernel::GEOMETRY_BILINEAR) {
            add_patch(bounds, scene, g, light.primitive);
        } else {
            add_quadric(bounds, scene, g);
        }
        return bounds;
    }
    bounds.add(glm::dvec3(light.p0));
    bounds.intensity = power / (4 * kPi);
    bounds.normals = kPi, bounds.emission = 0.5 * kPi;
    if (light.kind == kernel::LIGHT_SPOT) {
        const auto angle = [](double one_minus_cos) {
            return 2 * std::asin(std::sqrt(std::clamp(0.5 * one_minus_cos, 0.0, 1.0)));
        };
        const double begin = light.extent, end = light.inverse_area;  // light_record.h
        bounds.intensity = power / (kPi * (begin + end));
        bounds.axis = glm::dvec3(light.p1), bounds.normals = angle(begin), bounds.emission = angle(end) - angle(begin);
    } else if (light.kind == kernel::LIGHT_PROJECTION) {
        const auto [angle, solid_angle] = picture_angles(light);
        const kernel::TransformRecord& t = scene.transforms[light.transform];
        const glm::dvec3 axis(t.to0.z, t.to1.z, t.to2.z);
        bounds.intensity = power / solid_angle;
        // A transform that shears or stretches widens the cone: the axis alone is looked at where it does not.
        if (glm::length(axis) > 0)
            bounds.axis = glm::normalize(axis), bounds.normals = angle, bounds.emission = 0.5 * kPi;
    }
    return bounds;
}

LightBounds light_bounds(const Scene& scene, const kernel::LightRecord& light, double power) {
    LightBounds bounds = known_bounds(scene, light, power);
    // The narrowest beams have a solid angle of 0.
    if (!std::isfinite(bounds.intensity)) bounds.intensity = power / (4 * kPi);
    return bounds;
}

}  // namespace lampyris

#include "support/closed_mesh.h"

#include "core/device/device.h"
#include "support/build_text.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <stdexcept>
#include <utility>

namespace lampyris::test {
namespace {

using glm::uvec3;
using glm::uvec4;
using glm::vec3;
using glm::vec4;

struct Mesh {
    std::vector<vec3> points;
    std::vector<uvec3> triangles;
};

using Engine = std::mt19937_64;
float uniform(Engine& engine, float from, float to) { return std::uniform_real_distribution<float>(from, to)(engine); }

// An octahedron, divided four times; each point then moves along its radius.
Mesh rough_ball() {
    Mesh mesh{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
              {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
    for (int i = 0; i < 4; ++i) {
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
        const auto middle = [&](uint32_t a, uint32_t b) {
            const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), uint32_t(mesh.points.size()));
            if (is_new) mesh.points.push_back(glm::normalize(mesh.points[a] + mesh.points[b]));
            return place->second;
        };
        std::vector<uvec3> smaller;
        for (const uvec3& t : mesh.triangles) {
            const uint32_t ab = middle(t.x, t.y), bc = middle(t.y, t.z), ca = middle(t.z, t.x);
            for (const uvec3& part : {uvec3(t.x, ab, ca), uvec3(ab, t.y, bc), uvec3(ca, bc, t.z), uvec3(ab, bc, ca)})
                smaller.push_back(part);
        }
        mesh.triangles = std::move(smaller);
    }
    Engine engine(1);
    for (vec3& p : mesh.points) p *= uniform(engine, 0.8f, 1.0f);
    return mesh;
}

// Neighbours have vertices of their own, at the same places; coordinates are not exact in binary.
Mesh cube_of_squares() {
    constexpr int kCells = 24;
    Mesh mesh;
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0f, 1.0f}) {
            for (int cell = 0; cell < kCells * kCells; ++cell) {
                const auto first = uint32_t(mesh.points.size());
                for (int corner = 0; corner < 4; ++corner) {
                    vec3 p(side);
                    p[(axis + 1) % 3] = -1 + 2 * float(cell % kCells + corner % 2) / kCells;
                    p[(axis + 2) % 3] = -1 + 2 * float(cell / kCells + corner / 2) / kCells;  // NOLINT
                    mesh.points.push_back(p);
                }
                mesh.triangles.emplace_back(first, first + 1, first + 3);
                mesh.triangles.emplace_back(first, first + 3, first + 2);
            }
        }
    }
    return mesh;
}

// A prism whose lids are fans of 2000 triangles, with angles of 3e-3 in their middles.
Mesh drum_of_needles() {
    constexpr uint32_t kSides = 200;
    Mesh mesh{{{0, 0, -0.3f}, {0, 0, 0.3f}}, {}};
    for (uint32_t i = 0; i < kSides; ++i) {
        const float angle = 2 * std::numbers::pi_v<float> * float(i) / kSides;
        for (const float z : {-0.3f, 0.3f}) mesh.points.emplace_back(std::cos(angle), std::sin(angle), z);
        const uint32_t low = 2 + 2 * i, next = 2 + 2 * ((i + 1) % kSides);
        mesh.triangles.emplace_back(0, next, low);
        mesh.triangles.emplace_back(1, low + 1, next + 1);
        mesh.triangles.emplace_back(low, next, next + 1);
        mesh.triangles.emplace_back(low, next + 1, low + 1);
    }
    return mesh;
}

Mesh mesh_of(const std::string& name) {
    if (name == "ball") return rough_ball();
    if (name == "cube") return cube_of_squares();
    if (name == "drum") return drum_of_needles();
    throw std::invalid_argument(name);
}

BuiltText scene_of(const Mesh& mesh) {
    std::string points, indices;
    for (const vec3& p : mesh.points) points += fmt::format(" {:.9g} {:.9g} {:.9g}", p.x, p.y, p.z);
    for (const uvec3& t : mesh.triangles) indices += fmt::format(" {} {} {}", t.x, t.y, t.z);
    return build_world("Shape \"trianglemesh\" \"point3 P\" [" + points + " ] \"integer indices\" [" + indices +
                       " ]\n");
}

struct Ray {
    vec4 origin, direction;  // w of the origin: the farthest distance
};

Ray random_ray(const Mesh& mesh, Aim aim, Engine& engine) {
    constexpr float kFar = 3e38f, kInside = 0.12f;  // all meshes hold a cube of this half side
    const auto point = [&](float half) {
        const float x = uniform(engine, -half, half), y = uniform(engine, -half, half);
        return vec3(x, y, uniform(engine, -half, half));
    };
    const vec3 origin = point(kInside);
    const uvec3& t = mesh.triangles[engine() % mesh.triangles.size()];
    const vec3 a = mesh.points[t.x], b = mesh.points[t.y];
    const vec3 target =
        aim == Aim::kNowhere ? point(1) : (aim == Aim::kEdges ? a + uniform(engine, 0, 1) * (b - a) : a);
    const vec3 direction = target - origin;
    return {vec4(origin, kFar), vec4(direction / glm::length(direction), 0)};
}

}  // namespace

std::vector<std::string> closed_meshes() { return {"ball", "cube", "drum"}; }

Escaped escaped_rays(const std::string& mesh_name, const std::string& backend, uint64_t rays, Aim aim) {
    const Mesh mesh = mesh_of(mesh_name);
    const BuiltText built = scene_of(mesh);
    if (!built.errors.empty()) throw std::runtime_error(built.all_errors());
    const auto device = create_device(backend, {});
    const auto on_device = device->upload(built.scene());
    const auto kernel = device->compile("kernel/trace_probe.kernel.h", built.scene().effects.mask());
    constexpr uint64_t kBlock = 1 << 19;
    const size_t block = size_t(std::min(rays, kBlock));
    const auto in = device->create_buffer(block * sizeof(Ray), "rays");
    const auto out = device->create_buffer(block * sizeof(uvec4), "hits");
    std::vector<Ray> inputs(block);
    std::vector<uvec4> hits(block);
    Engine engine(2);
    Escaped escaped;
    for (uint64_t done = 0; done < rays; done += block) {
        for (Ray& ray : inputs) ray = random_ray(mesh, aim, engine);
        in->upload(inputs.data(), in->size());
        const NamedBuffer buffers[] = {{"rays", in}, {"hits", out}};
        device->run(*kernel, on_device.get(), buffers, 0, uint32_t(block));
        out->download(hits.data(), out->size());
        for (const uvec4& hit : hits) {
            escaped.closest += hit.y == kernel::NONE;
            escaped.occlusion += hit.w == 0;
        }
    }
    return escaped;
}

}  // namespace lampyris::test

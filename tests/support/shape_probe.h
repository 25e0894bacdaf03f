// Runs tests/kernel/shape_probe.kernel.h, and has quadrics in double precision.
#pragma once

#include "support/device_run.h"
#include "support/test_scene.h"

#include <algorithm>
#include <random>

namespace lampyris::test {

struct ShapeRay {
    glm::vec3 origin, direction;
    uint32_t geometry = 0, primitive = 0;
    glm::vec3 leave{0.0f, 0.0f, 1.0f};
    float t_max = 3.0e38f;
};

struct ShapeAnswer {
    bool hit = false;
    float t = 0;
    glm::vec2 uv;
    glm::vec3 position, error, ng, dpdu, dpdv, dndu, dndv;
    bool again = false;  // a ray that left the point in ShapeRay::leave found the shape again,
    float t_again = 0;   // there
    bool before_t_max = false;
};

inline std::vector<ShapeAnswer> ask_shapes(Device& device, const DeviceSceneHandle& scene,
                                           const std::vector<ShapeRay>& rays) {
    std::vector<glm::vec4> inputs;
    for (const ShapeRay& ray : rays) {
        inputs.emplace_back(ray.origin, float(ray.geometry));
        inputs.emplace_back(ray.direction, float(ray.primitive));
        inputs.emplace_back(ray.leave, ray.t_max);
    }
    constexpr size_t kResults = 9;
    const BufferHandle in = upload(device, inputs, "rays");
    const BufferHandle out = device.create_buffer(rays.size() * kResults * sizeof(glm::vec4), "results");
    const KernelHandle kernel =
        device.compile("kernel/shape_probe.kernel.h", kernel::EFFECT_QUADRICS | kernel::EFFECT_BILINEAR |
                                                          kernel::EFFECT_SMOOTH_NORMALS | kernel::EFFECT_BUMP);
    const NamedBuffer buffers[] = {{"rays", in}, {"results", out}};
    device.run(*kernel, scene.get(), buffers, 0, uint32_t(rays.size()));
    const auto v = download<glm::vec4>(out, rays.size() * kResults);
    std::vector<ShapeAnswer> answers(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) {
        const glm::vec4* r = &v[kResults * i];
        answers[i] = {r[0].x != 0,     r[0].y,          {r[0].z, r[0].w}, glm::vec3(r[1]), glm::vec3(r[2]),
                      glm::vec3(r[3]), glm::vec3(r[4]), glm::vec3(r[5]),  glm::vec3(r[6]), glm::vec3(r[7]),
                      r[8].x != 0,     r[8].y,          r[8].z != 0};
    }
    return answers;
}

// Points of a quadric by its parameters, in its own space (pbrt, 4th edition, sections 6.2 to 6.4), and its outward normal.
inline glm::dvec3 quadric_point(uint32_t kind, glm::dvec4 params, glm::dvec2 uv) {
    const double phi = uv.x * params.w;
    if (kind == kernel::GEOMETRY_SPHERE) {
        const double low = std::acos(std::clamp(params.y / params.x, -1.0, 1.0));
        const double high = std::acos(std::clamp(params.z / params.x, -1.0, 1.0));
        const double theta = low + uv.y * (high - low);
        return params.x * glm::dvec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
    }
    if (kind == kernel::GEOMETRY_CYLINDER)
        return {params.x * std::cos(phi), params.x * std::sin(phi), params.y + uv.y * (params.z - params.y)};
    const double r = params.y - uv.y * (params.y - params.z);
    return {r * std::cos(phi), r * std::sin(phi), params.x};
}
inline glm::dvec3 quadric_normal(uint32_t kind, glm::dvec3 p) {
    if (kind == kernel::GEOMETRY_SPHERE) return glm::normalize(p);
    if (kind == kernel::GEOMETRY_CYLINDER) return glm::normalize(glm::dvec3(p.x, p.y, 0));
    return {0, 0, 1};
}

inline glm::dvec3 random_direction(std::mt19937& rng) {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dvec3(normal(rng), normal(rng), normal(rng)));
}

}  // namespace lampyris::test

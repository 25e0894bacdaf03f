// Every backend's ray tracer finds the same hits: random rays against triangles, quadrics, patches and instances.
//
// Tracers round differently at edges, so a share of the rays may differ: at most kTies, of rays that graze an edge or hit two
// surfaces at the same distance. A tracer that loses a primitive or a subtree differs in far more.
#include "core/base/error.h"
#include "core/device/device.h"
#include "core/scene/scene.h"
#include "support/quadrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace lampyris {
namespace {

using glm::uvec4;
using glm::vec3;
using glm::vec4;

constexpr double kTies = 5e-4;
constexpr float kFar = 3.0e38f;

struct Ray {
    vec4 origin, direction;
};

kernel::TransformRecord scale_and_move(vec3 scale, vec3 by) {
    return {{scale.x, 0, 0, by.x},
            {0, scale.y, 0, by.y},
            {0, 0, scale.z, by.z},
            {1 / scale.x, 0, 0, -by.x / scale.x},
            {0, 1 / scale.y, 0, -by.y / scale.y},
            {0, 0, 1 / scale.z, -by.z / scale.z}};
}

struct TraceScene {
    Scene scene;
    TraceScene() {
        scene.sets.push_back({0, 0});
        scene.instances.push_back({scale_and_move(vec3(1), vec3(0)), 0, 0, 0, 0});
        scene.instance_sets.push_back(0);
    }
    uint32_t add(uint32_t kind, uint32_t primitives) {
        kernel::GeometryRecord g{};
        g.kind = kind;
        g.first_index = uint32_t(scene.indices.size());
        g.first_vertex = uint32_t(scene.positions.size() / 3);
        g.first_light = g.alpha_texture = kernel::NONE;
        g.primitive_count = primitives;
        g.alpha = 1.0f;
        scene.geometries.push_back(g);
        ++scene.sets.back().geometry_count;
        return uint32_t(scene.geometries.size() - 1);
    }
    // Polygons of 3 or 4 corners each, one geometry.
    void add_polygons(uint32_t corners, const std::vector<vec3>& vertices) {
        const uint32_t geometry = add(corners == 3 ? kernel::GEOMETRY_TRIANGLES : kernel::GEOMETRY_BILINEAR,
                                      uint32_t(vertices.size()) / corners);
        (void)geometry;
        for (uint32_t i = 0; i < vertices.size(); ++i) {
            scene.indices.push_back(i);
            for (int c = 0; c < 3; ++c) scene.positions.push_back(vertices[i][c]);
        }
        if (corners == 4) scene.effects.ask(kernel::EFFECT_BILINEAR, "test");
    }
    void add_quadric(uint32_t kind, vec4 params, const kernel::TransformRecord& transform) {
        const uint32_t geometry = add(kind, 1);
        scene.geometries[geometry].quadric = test::quadric_record(kind, params);
        scene.geometries[geometry].transform = uint32_t(scene.transforms.size());
        scene.transforms.push_back(transform);
        scene.effects.ask(kernel::EFFECT_QUADRICS, "test");
    }
    void begin_object() { scene.sets.push_back({uint32_t(scene.geometries.size()), 0}); }
    void add_instance(uint32_t set, const kernel::TransformRecord& transform) {
        scene.instances.push_back({transform, scene.sets[set].first_geometry, scene.sets[set].geometry_count, 0, 0});
        scene.instance_sets.push_back(set);
        scene.effects.ask(kernel::EFFECT_INSTANCES, "test");
    }
    Scene& finish() {
        scene.instances[0].geometry_count = scene.sets[0].geometry_count;
        scene.record.geometry_count = uint32_t(scene.geometries.size());
        scene.record.instance_count = uint32_t(scene.instances.size());
        scene.record_effects(kernel::kAllEffects);
        scene.positions.reserve(scene.positions.size() + 8);
        scene.positions.resize(scene.positions.size() + 4);  // Embree reads past the last vertex
        return scene;
    }
};

class Random {
 public:
    explicit Random(unsigned seed) : engine_(seed) {}
    float operator()() { return std::uniform_real_distribution<float>(-1, 1)(engine_); }
    vec3 point() {
        const float x = (*this)(), y = (*this)();
        return {x, y, (*this)()};
    }

 private:
    std::mt19937 engine_;
};

std::vector<vec3> random_triangles(Random& random, int count, float size) {
    std::vector<vec3> vertices;
    for (int i = 0; i < count; ++i) {
        const vec3 centre = random.point();
        for (int c = 0; c < 3; ++c) vertices.push_back(centre + size * random.point());
    }
    return vertices;
}

std::vector<Ray> random_rays(Random& random, int count, float scale = 1) {
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) {
        const vec3 o = scale * 2.0f * random.point();
        vec3 d = scale * random.point() - o;
        if (i % 4 != 0) d /= std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
        rays.push_back({vec4(o, i % 8 == 7 ? 0.7f * scale : kFar), vec4(d, 0)});
    }
    return rays;
}

struct Backend {
    std::string name;
    std::map<std::string, std::string> settings;
    std::string label;
};

// All tracers of this machine; ray query if a Vulkan device offers it.
std::vector<Backend> tracers() {
    std::vector<Backend> result;
    for (const DeviceInfo& info : list_devices()) {
        if (info.index != 0 || info.backend == "cpu") continue;
        if (info.backend == "cpu-bvh2") {
            result.push_back({info.backend, {}, info.backend});
            continue;
        }
        for (const char* wide : {"off", "auto"})
            result.push_back({"vulkan",
                              {{"ray_query", "off"}, {"wide_reads", wide}},
                              std::string("vulkan with wide reads ") + wide});
        const auto ray_query = info.features.find("ray_query");
        if (ray_query != info.features.end() && ray_query->second == "yes")
            result.push_back({"vulkan", {{"ray_query", "on"}}, "vulkan with ray query"});
    }
    return result;
}

std::vector<uvec4> trace(const Backend& backend, const Scene& scene, const std::vector<Ray>& rays) {
    DeviceOptions options;
    options.settings = backend.settings;
    const auto device = create_device(backend.name, options);
    const auto on_device = device->upload(scene);
    const auto kernel = device->compile("kernel/trace_probe.kernel.h", scene.effects.mask());
    const auto in = device->create_buffer(rays.size() * sizeof(Ray), "rays"),
               out = device->create_buffer(rays.size() * sizeof(uvec4), "hits");
    in->upload(rays.data(), in->size());
    const NamedBuffer buffers[] = {{"rays", in}, {"hits", out}};
    device->run(*kernel, on_device.get(), buffers, 0, uint32_t(rays.size()));
    std::vector<uvec4> hits(rays.size());
    out->download(hits.data(), out->size());
    return hits;
}

// Compares every tracer with Embree; returns the share of rays that hit.
double compare(const Scene& scene, const std::vector<Ray>& rays, double allowed = kTies) {
    const auto expected = trace({"cpu", {}, "cpu"}, scene, rays);
    const auto n = double(rays.size());
    for (const Backend& backend : tracers()) {
        const auto hits = trace(backend, scene, rays);
        int different = 0, occluded = 0, inconsistent = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            different += hits[i].x != expected[i].x || hits[i].y != expected[i].y || hits[i].z != expected[i].z;
            occluded += hits[i].w != expected[i].w;
            inconsistent += (hits[i].y != kernel::NONE) != (hits[i].w != 0);
        }
        EXPECT_LE(different / n, allowed) << backend.label << ": closest hits";
        EXPECT_LE(occluded / n, allowed) << backend.label << ": occlusion";
        EXPECT_LE(inconsistent / n, allowed) << backend.label << ": closest hit and occlusion contradict each other";
    }
    return double(std::count_if(expected.begin(), expected.end(),
                                [](const uvec4& hit) { return hit.y != kernel::NONE; })) /
           n;
}

TEST(Trace, TrianglesOfAllSizes) {
    Random random(1);
    TraceScene s;
    s.add_polygons(3, random_triangles(random, 3000, 0.03f));
    s.add_polygons(3, random_triangles(random, 40, 0.3f));
    s.add_polygons(3, random_triangles(random, 2, 3.0f));
    const double hit = compare(s.finish(), random_rays(random, 20000));
    EXPECT_GT(hit, 0.3);
    EXPECT_LT(hit, 0.99);
}

TEST(Trace, FewTrianglesAndNone) {
    Random random(2);
    for (const int count : {0, 1, 2, 5, 9}) {
        SCOPED_TRACE(count);
        TraceScene s;
        if (count) s.add_polygons(3, random_triangles(random, count, 0.8f));
        compare(s.finish(), random_rays(random, 5000));
    }
}

TEST(Trace, QuadricsAndPatches) {
    Random random(3);
    TraceScene s;
    s.add_polygons(3, random_triangles(random, 200, 0.1f));
    for (int i = 0; i < 8; ++i) {
        s.add_quadric(kernel::GEOMETRY_SPHERE, {0.2f, i % 2 ? -0.1f : -0.2f, 0.2f, i % 4 == 3 ? 4.0f : 6.2831853f},
                      scale_and_move(vec3(1, 1, 1 + 0.1f * float(i)), random.point()));
        s.add_quadric(kernel::GEOMETRY_DISK, {0.1f, 0.3f, i % 2 ? 0.1f : 0.0f, 6.2831853f},
                      scale_and_move(vec3(1), random.point()));
        s.add_quadric(kernel::GEOMETRY_CYLINDER, {0.15f, -0.2f, 0.2f, i % 4 == 1 ? 3.0f : 6.2831853f},
                      scale_and_move(vec3(1, 1.2f, 1), random.point()));
    }
    std::vector<vec3> corners;
    for (int i = 0; i < 12; ++i) {
        const vec3 p = random.point();
        for (const vec3& q : {vec3(0, 0, 0), vec3(0.3f, 0, 0), vec3(0, 0.3f, 0), vec3(0.3f, 0.3f, 0)})
            corners.push_back(p + q + 0.1f * random.point());
    }
    s.add_polygons(4, corners);
    const double hit = compare(s.finish(), random_rays(random, 20000));
    EXPECT_GT(hit, 0.2);
}

TEST(Trace, InstancesOfEverything) {
    Random random(4);
    TraceScene s;
    s.add_polygons(3, random_triangles(random, 100, 0.1f));
    s.begin_object();
    s.add_polygons(3, random_triangles(random, 50, 0.4f));
    s.add_quadric(kernel::GEOMETRY_SPHERE, {0.5f, -0.5f, 0.5f, 6.2831853f}, scale_and_move(vec3(1), vec3(0.2f)));
    s.begin_object();
    s.add_polygons(3, random_triangles(random, 1, 1.5f));
    s.begin_object();  // an empty object, instanced
    for (int i = 0; i < 60; ++i)
        s.add_instance(1 + uint32_t(i % 3), scale_and_move(vec3(0.2f, i % 5 ? 0.2f : -0.2f, 0.3f), random.point()));
    const double hit = compare(s.finish(), random_rays(random, 20000));
    EXPECT_GT(hit, 0.2);
}

TEST(Trace, OnlyInstances) {
    Random random(5);
    TraceScene s;
    s.begin_object();
    s.add_polygons(3, random_triangles(random, 20, 0.5f));
    for (int i = 0; i < 3; ++i) s.add_instance(1, scale_and_move(vec3(0.5f), random.point()));
    EXPECT_GT(compare(s.finish(), random_rays(random, 5000)), 0.1);
}

// Comparisons with NaN are false: the traversal must neither visit everything nor loop in an empty tree.
TEST(Trace, RaysThatAreNotFiniteMeetNothing) {
    Random random(20);
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
    std::vector<Ray> rays;
    for (const Ray& ray : random_rays(random, 60)) {
        for (const float bad : {kNan, kInf, -kInf}) {
            rays.push_back(ray);
            (rays.size() % 2 ? rays.back().origin : rays.back().direction)[int(rays.size() / 2 % 3)] = bad;
        }
    }
    for (const int count : {0, 1, 200}) {
        SCOPED_TRACE(count);
        TraceScene s;
        if (count) s.add_polygons(3, random_triangles(random, count, 0.8f));
        s.begin_object();
        if (count) s.add_polygons(3, random_triangles(random, count, 0.8f));
        for (int i = 0; i < 4; ++i) s.add_instance(1, scale_and_move(vec3(i == 3 ? 1e-38f : 0.5f), random.point()));
        const Scene& scene = s.finish();
        for (const Backend& backend : tracers()) {
            if (backend.settings.contains("ray_query") && backend.settings.at("ray_query") == "on") continue;
            for (const uvec4& hit : trace(backend, scene, rays)) {
                ASSERT_EQ(hit.y, kernel::NONE) << backend.label;
                ASSERT_EQ(hit.w, 0u) << backend.label;
            }
        }
    }
}

TEST(Trace, DegenerateTrianglesAreMissed) {
    Random random(6);
    TraceScene s;
    std::vector<vec3> vertices = random_triangles(random, 50, 0.3f);
    for (int i = 0; i < 20; ++i) {
        const vec3 p = random.point(), q = random.point();
        vertices.insert(vertices.end(), {p, p, p, p, q, p, p, 0.5f * (p + q), q});
    }
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
    vertices.insert(vertices.end(), {vec3(kNan, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0), vec3(kInfinity, 0, 0),
                                     vec3(1, 0, 0), vec3(0, 1, 0)});
    s.add_polygons(3, vertices);
    compare(s.finish(), random_rays(random, 10000));
}

// Rays along the axes, in the planes of the boxes that bound axis-parallel rectangles, and away from their edges.
TEST(Trace, AxisParallelRays) {
    TraceScene s;
    std::vector<vec3> vertices;
    for (int i = 0; i < 10; ++i) {
        for (int j = 0; j < 10; ++j) {
            const float x = float(i), y = float(j), z = float((i * 7 + j * 3) % 5);
            vertices.insert(vertices.end(), {vec3(x, y, z), vec3(x + 1, y, z), vec3(x, y + 1, z), vec3(x + 1, y, z),
                                             vec3(x + 1, y + 1, z), vec3(x, y + 1, z)});
        }
    }
    s.add_polygons(3, vertices);
    std::vector<Ray> rays;
    for (int i = 0; i < 10; ++i) {
        for (int j = 0; j < 10; ++j) {
            const float x = float(i) + 0.3f, y = float(j) + 0.2f;
            for (const float z : {-1.0f, 0.0f, 2.5f, 9.0f}) {
                rays.push_back({vec4(x, y, z, kFar), vec4(0, 0, 1, 0)});
                rays.push_back({vec4(x, y, z, kFar), vec4(-0.0f, 0, -1, 0)});
                rays.push_back({vec4(-1, y, z, kFar), vec4(1, 0, -0.0f, 0)});
            }
        }
    }
    EXPECT_GT(compare(s.finish(), rays, 0.0), 0.3);
}

TEST(Trace, HugeAndSmallCoordinates) {
    for (const float scale : {1e-6f, 1e-3f, 1e3f, 1e6f}) {
        SCOPED_TRACE(scale);
        Random random(8);
        TraceScene s;
        std::vector<vec3> vertices = random_triangles(random, 500, 0.2f);
        for (vec3& v : vertices) v *= scale;
        s.add_polygons(3, vertices);
        EXPECT_GT(compare(s.finish(), random_rays(random, 5000, scale)), 0.3);
    }
}

// A regular mesh is closed: rays from inside a cube of many triangles always hit, up to rays through edges.
TEST(Trace, ClosedMeshHasNoHoles) {
    constexpr int kCells = 24;
    Random random(9);
    TraceScene s;
    std::vector<vec3> vertices;
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0f, 1.0f}) {
            const auto corner = [&](int i, int j) {
                vec3 p;
                p[axis] = side;
                p[(axis + 1) % 3] = -1 + 2 * float(i) / kCells;
                p[(axis + 2) % 3] = -1 + 2 * float(j) / kCells;
                return p;
            };
            for (int i = 0; i < kCells; ++i) {
                for (int j = 0; j < kCells; ++j) {
                    vertices.insert(vertices.end(), {corner(i, j), corner(i + 1, j), corner(i, j + 1), corner(i + 1, j),
                                                     corner(i + 1, j + 1), corner(i, j + 1)});
                }
            }
        }
    }
    s.add_polygons(3, vertices);
    std::vector<Ray> rays;
    for (int i = 0; i < 20000; ++i) rays.push_back({vec4(0.9f * random.point(), kFar), vec4(random.point(), 0)});
    EXPECT_GT(compare(s.finish(), rays), 0.9999);
}

}  // namespace
}  // namespace lampyris

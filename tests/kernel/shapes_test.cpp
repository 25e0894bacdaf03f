// Quadrics and bilinear patches: the points where rays hit them, and the surface there, against their parametric definitions.
#include "support/shape_probe.h"

#include <gtest/gtest.h>

#include <numbers>

namespace lampyris::test {
namespace {

using glm::dmat4;
using glm::dvec2;
using glm::dvec3;
using glm::dvec4;
using glm::vec3;
using glm::vec4;

constexpr float kPi = std::numbers::pi_v<float>;

struct Named {
    const char* name;
    uint32_t kind;
    vec4 params;
    dmat4 to;
    uint32_t flags;
};

dmat4 skewed() {
    dmat4 m(1.0);
    m = glm::translate(m, dvec3(1, -2, 3));
    m = glm::rotate(m, 0.7, glm::normalize(dvec3(1, 2, -1)));
    m = glm::scale(m, dvec3(1.5, 0.7, 2.0));
    return m;
}

std::vector<Named> quadrics() {
    const dmat4 one(1.0);
    const dmat4 mirrored = skewed() * glm::scale(dmat4(1.0), dvec3(-1, 1, 1));
    return {
        {"sphere", kernel::GEOMETRY_SPHERE, {1.5f, -1.5f, 1.5f, 2 * kPi}, one, 0},
        {"sphere in part", kernel::GEOMETRY_SPHERE, {2.0f, -0.5f, 1.25f, 4.0f}, one, 0},
        {"ellipsoid", kernel::GEOMETRY_SPHERE, {1.0f, -1.0f, 1.0f, 2 * kPi}, skewed(), 0},
        {"ellipsoid in part, turned round",
         kernel::GEOMETRY_SPHERE,
         {1.0f, -0.8f, 0.3f, 2.5f},
         mirrored,
         kernel::GEOMETRY_FLIP},
        {"cylinder", kernel::GEOMETRY_CYLINDER, {0.8f, -1.0f, 1.5f, 2 * kPi}, one, 0},
        {"cylinder in part", kernel::GEOMETRY_CYLINDER, {1.0f, -0.5f, 0.75f, 4.5f}, mirrored, 0},
        {"cylinder turned round",
         kernel::GEOMETRY_CYLINDER,
         {1.0f, -0.5f, 0.75f, 2 * kPi},
         skewed(),
         kernel::GEOMETRY_FLIP},
        {"disk", kernel::GEOMETRY_DISK, {0.25f, 1.0f, 0.0f, 2 * kPi}, one, 0},
        {"ring in part", kernel::GEOMETRY_DISK, {-0.5f, 2.0f, 0.75f, 3.5f}, skewed(), kernel::GEOMETRY_FLIP},
    };
}

// Rays aimed at random points of the shape: they hit it there or before.
TEST(Shapes, QuadricsAreTheirParametricSurfaces) {
    TestScene scene;
    const std::vector<Named> shapes = quadrics();
    for (const Named& shape : shapes) scene.add_quadric(shape.kind, shape.params, shape.to, shape.flags);
    scene.finish();
    constexpr int kRays = 400;
    std::mt19937 rng(1);
    std::uniform_real_distribution<double> uniform(0.001, 0.999);
    std::vector<ShapeRay> rays;
    std::vector<double> t_aimed;
    for (uint32_t i = 0; i < shapes.size(); ++i) {
        for (int k = 0; k < kRays; ++k) {
            const dvec2 uv(uniform(rng), uniform(rng));
            const dvec3 target = shapes[i].to * dvec4(quadric_point(shapes[i].kind, shapes[i].params, uv), 1.0);
            const dvec3 origin = target + 6.0 * random_direction(rng);
            ShapeRay ray{vec3(origin), vec3(0.5 * (target - dvec3(vec3(origin)))), i};
            rays.push_back(ray);
            t_aimed.push_back(2.0);
        }
    }
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        const auto answers = ask_shapes(*device, device->upload(scene.scene), rays);
        for (size_t n = 0; n < rays.size(); ++n) {
            const Named& shape = shapes[n / kRays];
            const ShapeAnswer& a = answers[n];
            const dvec3 chord = rays[n].direction;
            SCOPED_TRACE(::testing::Message() << shape.name << " ray " << n);
            // Rays that graze the surface at their target may miss it.
            const dvec3 m_normal = glm::dmat3(glm::transpose(glm::inverse(glm::dmat3(shape.to)))) *
                                   quadric_normal(shape.kind, dvec3(glm::inverse(shape.to) *
                                                                    dvec4(dvec3(rays[n].origin) + 2.0 * chord, 1.0)));
            const double aimed_cosine = std::abs(glm::dot(glm::normalize(m_normal), glm::normalize(chord)));
            if (!a.hit) {
                EXPECT_LT(aimed_cosine, 1e-2);
                continue;
            }
            EXPECT_LE(a.t, t_aimed[n] * (1 + 1e-4) + 1e-5 / std::max(aimed_cosine, 1e-3));
            // The point is P(u, v), and on the ray.
            const dvec2 uv(a.uv);
            const auto point = [&](dvec2 at) {
                return dvec3(shape.to * dvec4(quadric_point(shape.kind, shape.params, at), 1.0));
            };
            const auto normal = [&](dvec2 at) {
                dvec3 m = glm::transpose(glm::inverse(glm::dmat3(shape.to))) *
                          quadric_normal(shape.kind, quadric_point(shape.kind, shape.params, at));
                return glm::normalize(m) * (shape.flags & kernel::GEOMETRY_FLIP ? -1.0 : 1.0);
            };
            EXPECT_LT(glm::length(dvec3(a.position) - point(uv)), 2e-5);
            const dvec3 on_ray = dvec3(rays[n].origin) + double(a.t) * chord;
            const double cosine = std::max(1e-3, std::abs(glm::dot(dvec3(a.ng), glm::normalize(chord))));
            EXPECT_LT(glm::length(dvec3(a.position) - on_ray), 1e-5 / cosine);
            EXPECT_LT(glm::length(dvec3(a.ng) - normal(uv)), 1e-4);
            const double pole =
                shape.kind == kernel::GEOMETRY_SPHERE || shape.kind == kernel::GEOMETRY_DISK ? 0.02 : 0.0;
            if (uv.y < pole || uv.y > 1 - pole) continue;  // derivatives are large there
            const double h = 1e-5;
            const auto derivative = [h](const auto& f, dvec2 at, dvec2 along) {
                return (f(at + h * along) - f(at - h * along)) / (2 * h);
            };
            const double scale = glm::length(dvec3(a.dpdu)) + glm::length(dvec3(a.dpdv));
            EXPECT_LT(glm::length(dvec3(a.dpdu) - derivative(point, uv, {1, 0})), 1e-3 * scale);
            EXPECT_LT(glm::length(dvec3(a.dpdv) - derivative(point, uv, {0, 1})), 1e-3 * scale);
            const double bend = 1.0 + glm::length(dvec3(a.dndu)) + glm::length(dvec3(a.dndv));
            EXPECT_LT(glm::length(dvec3(a.dndu) - derivative(normal, uv, {1, 0})), 1e-3 * bend);
            EXPECT_LT(glm::length(dvec3(a.dndv) - derivative(normal, uv, {0, 1})), 1e-3 * bend);
        }
    }
}

TEST(Shapes, PartsThatAreMissingAreMissed) {
    TestScene scene;
    const uint32_t bowl = scene.add_quadric(kernel::GEOMETRY_SPHERE, {1, -1, 0.5f, 2 * kPi});
    const uint32_t half = scene.add_quadric(kernel::GEOMETRY_SPHERE, {1, -1, 1, kPi});
    const uint32_t tube = scene.add_quadric(kernel::GEOMETRY_CYLINDER, {1, -1, 1, kPi});
    const uint32_t ring = scene.add_quadric(kernel::GEOMETRY_DISK, {0, 1, 0.5f, 2 * kPi});
    const uint32_t whole = scene.add_quadric(kernel::GEOMETRY_SPHERE, {1, -1, 1, 2 * kPi});
    scene.finish();
    struct Case {
        vec3 o, d;
        uint32_t shape;
        float t;  // 0: missed
    };
    const std::vector<Case> cases = {
        {{0, 0, 3}, {0, 0, -1}, bowl, 4},  // through the opening to the bottom
        {{0, 0, -3}, {0, 0, 1}, bowl, 2},
        {{0.1f, -3, 0}, {0, 1, 0}, half, 0},  // y > 0 exists: the near side is missing; far side at y = sqrt(0.99)
        {{0, 3, 0.1f}, {0, -1, 0}, tube, 2},
        {{0, -3, 0.1f}, {0, 1, 0}, tube, 4},
        {{0, 3, 1.1f}, {0, -1, 0}, tube, 0},
        {{0, 0.2f, 0}, {0, 0, 1}, tube, 0},  // along the axis
        {{0.2f, 0, 1}, {0, 0, -1}, ring, 0},
        {{0.7f, 0, 1}, {0, 0, -2}, ring, 0.5f},  // t counts lengths of the direction
        {{1.1f, 0, 1}, {0, 0, -1}, ring, 0},
        {{0.7f, 0, 1}, {0, 0, 1}, ring, 0},
        {{0.7f, 0, 1}, {1, 0, 0}, ring, 0},  // parallel
        {{0, 0, 0}, {0, 0, 3}, whole, 1.0f / 3},
        {{0, 0, 2}, {0, 0, 1}, whole, 0},
        {{2, 0, 0}, {0, 0, 1}, whole, 0},
    };
    std::vector<ShapeRay> rays;
    for (const Case& c : cases) {
        rays.push_back({c.o, c.d, c.shape});
        rays.back().t_max = c.t * 0.999f;
        rays.push_back({c.o, c.d, c.shape});
        rays.back().t_max = c.t * 1.001f;
    }
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        const auto answers = ask_shapes(*device, device->upload(scene.scene), rays);
        for (size_t i = 0; i < cases.size(); ++i) {
            SCOPED_TRACE(i);
            float expected = cases[i].t;
            if (i == 2) {
                EXPECT_TRUE(answers[2 * i].hit);
                expected = 3 + std::sqrt(0.99f);
            }
            EXPECT_EQ(answers[2 * i].hit, expected > 0);
            EXPECT_NEAR(answers[2 * i].t, expected, 1e-6);
            if (i == 2) continue;
            EXPECT_FALSE(answers[2 * i].before_t_max);
            EXPECT_EQ(answers[2 * i + 1].before_t_max, expected > 0);
        }
    }
}

// Rays through random points of patches: plane, warped, and with a corner collapsed; uv, derivatives, vertex uvs and normals.
TEST(Shapes, PatchesAreTheirParametricSurfaces) {
    struct Case {
        const char* name;
        std::array<vec3, 4> p;
        uint32_t flags;
    };
    const std::vector<Case> cases = {
        {"rectangle", {vec3(-1, -1, 0), vec3(1, -1, 0), vec3(-1, 1, 0), vec3(1, 1, 0)}, 0},
        {"trapezium, turned round",
         {vec3(-1, -1, 0), vec3(1, -1, 0), vec3(-0.3f, 1, 0), vec3(0.4f, 1, 0)},
         kernel::GEOMETRY_FLIP},
        {"saddle", {vec3(-1, -1, 0.7f), vec3(1, -1, -0.5f), vec3(-1, 1, -0.8f), vec3(1, 1, 0.6f)}, 0},
        {"warped, with uvs",
         {vec3(-1, -1, 0.1f), vec3(1.5f, -1, -0.4f), vec3(-1, 1, 0), vec3(1, 1, 0.3f)},
         kernel::GEOMETRY_HAS_UVS},
        {"warped, with normals",
         {vec3(-1, -1, 0.1f), vec3(1.5f, -1, -0.4f), vec3(-1, 1, 0), vec3(1, 1, 0.3f)},
         kernel::GEOMETRY_HAS_NORMALS},
        {"triangle", {vec3(-1, -1, 0), vec3(1, -1, 0), vec3(0, 1, 0), vec3(0, 1, 0)}, 0},
    };
    TestScene scene;
    for (const Case& c : cases) {
        scene.add_polygon<4>(c.p, c.flags);
        if (c.flags & kernel::GEOMETRY_HAS_UVS) scene.scene.uvs = {0, 0, 2, 0, 0, 3, 2.5f, 2};
        if (c.flags & kernel::GEOMETRY_HAS_NORMALS) scene.scene.normals = {-1, -1, -3, 1, -1, -3, -1, 1, -3, 1, 1, -3};
    }
    scene.finish();
    constexpr int kRays = 400;
    std::mt19937 rng(2);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<ShapeRay> rays;
    std::vector<dvec2> aimed;
    const auto patch = [&](const Case& c, dvec2 uv) {
        return (1 - uv.x) * ((1 - uv.y) * dvec3(c.p[0]) + uv.y * dvec3(c.p[2])) +
               uv.x * ((1 - uv.y) * dvec3(c.p[1]) + uv.y * dvec3(c.p[3]));
    };
    for (uint32_t i = 0; i < cases.size(); ++i) {
        for (int k = 0; k < kRays; ++k) {
            const dvec2 uv(uniform(rng), uniform(rng));
            const dvec3 target = patch(cases[i], uv);
            dvec3 direction = random_direction(rng);
            direction.z = direction.z < 0 ? direction.z - 0.4 : direction.z + 0.4;
            const dvec3 origin = vec3(target + 5.0 * direction);
            rays.push_back({vec3(origin), vec3(target - origin), i});
            aimed.push_back(uv);
        }
    }
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        const auto answers = ask_shapes(*device, device->upload(scene.scene), rays);
        for (size_t n = 0; n < rays.size(); ++n) {
            const Case& c = cases[n / kRays];
            const ShapeAnswer& a = answers[n];
            SCOPED_TRACE(::testing::Message() << c.name << " ray " << n);
            ASSERT_TRUE(a.hit);
            EXPECT_LT(glm::length(dvec3(a.position) - (dvec3(rays[n].origin) + double(a.t) * dvec3(rays[n].direction))),
                      4e-5);
            if (a.t < 0.999f) continue;  // rays hit a saddle before the target
            EXPECT_NEAR(a.t, 1, 1e-4);
            const dvec2 uv = aimed[n];
            dvec3 pu = (1 - uv.y) * dvec3(c.p[1] - c.p[0]) + uv.y * dvec3(c.p[3] - c.p[2]);
            dvec3 pv = (1 - uv.x) * dvec3(c.p[2] - c.p[0]) + uv.x * dvec3(c.p[3] - c.p[1]);
            dvec3 normal = glm::normalize(glm::cross(pu, pv));
            const double cosine = std::abs(glm::dot(normal, glm::normalize(dvec3(rays[n].direction))));
            EXPECT_LT(glm::length(dvec3(a.position) - patch(c, uv)), 1e-5 / std::max(cosine, 0.02));
            if (c.flags & kernel::GEOMETRY_FLIP) normal = -normal;
            if (c.flags & kernel::GEOMETRY_HAS_NORMALS) normal = -normal;  // to the vertex normals' side
            if (uv.y > 0.99) continue;                                     // the triangle's tip
            EXPECT_LT(glm::length(dvec3(a.ng) - normal), 1e-3);
            if (c.flags & kernel::GEOMETRY_HAS_UVS) {
                const auto st = [](dvec2 at) {
                    return (1 - at.x) * at.y * dvec2(0, 3) + at.x * ((1 - at.y) * dvec2(2, 0) + at.y * dvec2(2.5, 2));
                };
                EXPECT_LT(glm::length(dvec2(a.uv) - st(uv)), 1e-4);
                // dP = dpds ds + dpdt dt for a small step.
                const double h = 1e-6;
                for (const dvec2 step : {dvec2(h, 0), dvec2(0, h)}) {
                    const dvec2 dst = st(uv + step) - st(uv);
                    const dvec3 dp = patch(c, uv + step) - patch(c, uv);
                    EXPECT_LT(glm::length(dvec3(a.dpdu) * dst.x + dvec3(a.dpdv) * dst.y - dp) / h, 1e-3);
                }
            } else {
                EXPECT_LT(glm::length(dvec2(a.uv) - uv), 1e-4 / std::max(1 - uv.y, 0.05));
                EXPECT_LT(glm::length(dvec3(a.dpdu) - pu), 1e-3);
                EXPECT_LT(glm::length(dvec3(a.dpdv) - pv), 1e-3);
            }
        }
    }
}

}  // namespace
}  // namespace lampyris::test

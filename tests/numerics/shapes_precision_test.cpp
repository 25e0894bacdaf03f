// Rounding in shape intersection, against long double: tiny and huge shapes, far from the ray and from the world's origin.
//
// Unit of error: eps M, with eps half a unit in the last place and M the size, in radii, of the numbers from which the ray's
// origin in the shape's space is computed. No formula can be better than a small multiple of it; formulas with cancellation
// lose M times more.
#include "support/shape_probe.h"

#include <gtest/gtest.h>

namespace lampyris::test {
namespace {

using glm::dmat4;
using glm::dvec3;
using glm::vec3;
using glm::vec4;
using Long3 = glm::vec<3, long double>;

constexpr double kEps = 5.9604645e-8;
constexpr float kTwoPi = 6.28318530717958648f;

struct Scale {
    double radius, translation, distance;  // the latter two in radii
};
std::vector<Scale> scales() {
    std::vector<Scale> all;
    for (const double radius : {1e-5, 1.0, 1e6})
        for (const double translation : {0.0, 10.0, 1e4})
            for (const double distance : {1.5, 1e2, 1e4}) all.push_back({radius, translation, distance});
    return all;
}

Long3 transform(const vec4& r0, const vec4& r1, const vec4& r2, Long3 p, long double w) {
    const auto row = [&](const vec4& r) { return r.x * p.x + r.y * p.y + r.z * p.z + (long double)(r.w) * w; };
    return {row(r0), row(r1), row(r2)};
}

struct Arrangement {
    TestScene scene;
    std::vector<ShapeRay> rays;
    std::vector<Scale> scale_of;
};

constexpr int kRays = 300;

Arrangement make(uint32_t kind) {
    Arrangement s;
    std::mt19937 rng(11);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (const Scale& scale : scales()) {
        const auto r = float(scale.radius);
        const vec4 params = kind == kernel::GEOMETRY_DISK ? vec4(0, r, 0, kTwoPi) : vec4(r, -r, r, kTwoPi);
        const dvec3 centre = scale.radius * scale.translation * random_direction(rng);
        const dmat4 to = glm::rotate(glm::translate(dmat4(1.0), centre), 0.8, random_direction(rng));
        const uint32_t geometry = s.scene.add_quadric(kind, params, to);
        for (int i = 0; i < kRays; ++i) {
            const dvec3 origin = centre + scale.radius * scale.distance * random_direction(rng);
            const dvec3 target = centre + 0.8 * scale.radius * dvec3(uniform(rng), uniform(rng), uniform(rng));
            s.rays.push_back({vec3(origin), vec3((target - origin) * std::exp(uniform(rng))), geometry});
            s.scale_of.push_back(scale);
        }
    }
    s.scene.finish();
    return s;
}

// Distance of a point to the quadric's surface (not its edges), in the set's space.
double distance_to_surface(const Scene& scene, uint32_t geometry, dvec3 p) {
    const kernel::GeometryRecord& g = scene.geometries[geometry];
    const kernel::TransformRecord& m = scene.transforms[g.transform];
    const Long3 q = transform(m.from0, m.from1, m.from2, Long3(p), 1);
    if (g.kind == kernel::GEOMETRY_SPHERE) return double(glm::length(q) - g.quadric.radius);
    if (g.kind == kernel::GEOMETRY_DISK) return double(q.z - g.quadric.height);
    return double(std::sqrt(q.x * q.x + q.y * q.y) - g.quadric.radius);
}

TEST(ShapesPrecision, HitsAreWithinAFewRoundingErrors) {
    for (const uint32_t kind : {kernel::GEOMETRY_SPHERE, kernel::GEOMETRY_CYLINDER, kernel::GEOMETRY_DISK}) {
        const Arrangement setup = make(kind);
        const Scene& scene = setup.scene.scene;
        for (const std::string& backend : usable_backends()) {
            const auto device = create_device(backend);
            const auto answers = ask_shapes(*device, device->upload(scene), setup.rays);
            int compared = 0, hits = 0;
            double worst = 0;
            for (size_t i = 0; i < setup.rays.size(); ++i) {
                const ShapeRay& ray = setup.rays[i];
                const kernel::GeometryRecord& g = scene.geometries[ray.geometry];
                const kernel::TransformRecord& m = scene.transforms[g.transform];
                const long double r = g.quadric.radius;
                const Long3 o = transform(m.from0, m.from1, m.from2, Long3(ray.origin), 1) / r;
                const Long3 d = transform(m.from0, m.from1, m.from2, Long3(ray.direction), 0) / r;
                // The size of the terms whose sum is o.
                const Long3 size =
                    transform(glm::abs(m.from0), glm::abs(m.from1), glm::abs(m.from2), Long3(glm::abs(ray.origin)), 1) /
                    r;
                const double delta = 16 * kEps * double(std::max({size.x, size.y, size.z, 1.0L}));
                if (delta > 0.01) continue;
                long double t = -1, cosine = 1;
                bool unsure = false;
                if (kind == kernel::GEOMETRY_DISK) {
                    t = -o.z / d.z;
                    cosine = std::abs(d.z) / glm::length(d);
                    const Long3 p = o + t * d;
                    const long double rho = glm::length(p);
                    unsure = std::abs(rho - 1) < delta / cosine || std::abs(o.z) < delta;
                    if (rho > 1) t = -1;
                } else {
                    const long double use_z = kind == kernel::GEOMETRY_SPHERE ? 1 : 0;
                    const Long3 f(o.x, o.y, o.z * use_z), e(d.x, d.y, d.z * use_z);
                    const long double a = glm::dot(e, e), b = -glm::dot(f, e) / a;
                    const Long3 l = f + b * e;
                    const long double discriminant = 1 - glm::dot(l, l);
                    unsure = std::abs(discriminant) < 8 * delta;
                    if (discriminant > 0) {
                        cosine = std::sqrt(discriminant);
                        const long double half = std::sqrt(discriminant / a);
                        for (const long double root : {b + half, b - half}) {
                            const long double z = o.z + root * d.z;
                            if (kind == kernel::GEOMETRY_CYLINDER &&
                                std::abs(std::abs(z) - 1) < 8 * delta / cosine * glm::length(d) / std::sqrt(a))
                                unsure = true;
                            if (root > 0 && (kind == kernel::GEOMETRY_SPHERE || std::abs(z) <= 1)) t = root;
                            if (std::abs(root) * glm::length(d) < 8 * delta / cosine) unsure = true;
                        }
                    }
                }
                if (unsure) continue;
                ++compared;
                const ShapeAnswer& answer = answers[i];
                ASSERT_EQ(answer.hit, t > 0) << backend << " kind " << kind << " ray " << i;
                if (!answer.hit) continue;
                ++hits;
                const double error = double(std::abs(answer.t - t) * glm::length(d) * cosine) / (delta / 16);
                worst = std::max(worst, error);
                EXPECT_LT(error, 12) << backend << " kind " << kind << " ray " << i;
                // The error bound holds.
                const double bound = glm::dot(glm::abs(dvec3(answer.ng)), dvec3(answer.error));
                EXPECT_LT(std::abs(distance_to_surface(scene, ray.geometry, answer.position)), bound)
                    << backend << " kind " << kind << " ray " << i;
                EXPECT_LT(bound, 2 * delta * double(r) + 32 * kEps * glm::length(glm::abs(dvec3(answer.position))));
            }
            EXPECT_GT(compared, 2000);
            EXPECT_GT(hits, 1000);
            RecordProperty("worst_error_in_eps_M", std::to_string(worst));
        }
    }
}

// A ray that leaves a point of a shape does not find that point again; from inside a sphere it always finds the other side.
TEST(ShapesPrecision, RaysLeaveTheSurfaceThatTheyStartFrom) {
    for (const uint32_t kind : {kernel::GEOMETRY_SPHERE, kernel::GEOMETRY_CYLINDER, kernel::GEOMETRY_DISK}) {
        Arrangement setup = make(kind);
        for (const std::string& backend : usable_backends()) {
            const auto device = create_device(backend);
            const auto device_scene = device->upload(setup.scene.scene);
            std::vector<ShapeRay> rays = setup.rays;
            const auto first = ask_shapes(*device, device_scene, rays);
            std::mt19937 rng(5);
            std::uniform_real_distribution<double> uniform(0, 1);
            std::vector<double> cosines(rays.size());
            for (size_t i = 0; i < rays.size(); ++i) {
                if (!first[i].hit) continue;
                // Down to grazing by 1e-5, on either side.
                cosines[i] = std::pow(10.0, -5 * uniform(rng)) * (uniform(rng) < 0.5 ? -1 : 1);
                const dvec3 n = glm::normalize(dvec3(first[i].ng));
                const dvec3 tangent = glm::normalize(glm::cross(n, random_direction(rng)));
                rays[i].leave = vec3(cosines[i] * n + std::sqrt(1 - cosines[i] * cosines[i]) * tangent);
            }
            const auto answers = ask_shapes(*device, device_scene, rays);
            int outside = 0, inside = 0;
            for (size_t i = 0; i < rays.size(); ++i) {
                if (!first[i].hit) continue;
                SCOPED_TRACE(::testing::Message()
                             << backend << " kind " << kind << " ray " << i << " cosine " << cosines[i] << " t "
                             << answers[i].t_again << " radius " << setup.scale_of[i].radius << " translation "
                             << setup.scale_of[i].translation);
                if (kind == kernel::GEOMETRY_DISK || cosines[i] > 0) {
                    ++outside;
                    EXPECT_FALSE(answers[i].again);
                } else if (kind == kernel::GEOMETRY_SPHERE) {
                    // The length of the chord, compared with the part that the rounding of the surface point may cut off.
                    const double chord = -2 * cosines[i];
                    const double noise = 64 * kEps * (1 + setup.scale_of[i].translation);
                    if (chord < 0.05 * std::sqrt(noise)) continue;
                    ++inside;
                    EXPECT_TRUE(answers[i].again);
                    if (chord > 4 * std::sqrt(noise)) {
                        EXPECT_NEAR(answers[i].t_again / (chord * setup.scale_of[i].radius), 1, 0.25);
                    }
                }
            }
            EXPECT_GT(outside, 1000);
            if (kind == kernel::GEOMETRY_SPHERE) {
                EXPECT_GT(inside, 700);
            }
        }
    }
}

TEST(ShapesPrecision, PatchesToo) {
    TestScene scene;
    std::mt19937 rng(4);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<ShapeRay> rays;
    for (const double radius : {1e-5, 1.0, 1e6}) {
        for (const double translation : {0.0, 10.0, 1e3}) {
            const dvec3 centre = radius * translation * random_direction(rng);
            const dvec3 x = random_direction(rng), y = glm::normalize(glm::cross(x, random_direction(rng)));
            std::array<vec3, 4> p;
            for (int k = 0; k < 4; ++k)
                p[size_t(k)] = vec3(centre + radius * ((k & 1 ? 1.0 : -1.0) * x + (k & 2 ? 1.0 : -1.0) * y));
            const uint32_t geometry = scene.add_polygon<4>(p);
            for (int i = 0; i < kRays; ++i) {
                const dvec3 target =
                    centre + radius * ((1.8 * uniform(rng) - 0.9) * x + (1.8 * uniform(rng) - 0.9) * y);
                const dvec3 origin = centre + radius * 100.0 * random_direction(rng);
                rays.push_back({vec3(origin), vec3(target - origin), geometry});
            }
        }
    }
    scene.finish();
    for (const std::string& backend : usable_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        const auto device_scene = device->upload(scene.scene);
        const auto first = ask_shapes(*device, device_scene, rays);
        std::vector<ShapeRay> leaving = rays;
        int hits = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            const double cosine =
                std::abs(glm::dot(glm::normalize(dvec3(rays[i].direction)), glm::normalize(dvec3(first[i].ng))));
            if (!first[i].hit || cosine < 0.02) continue;
            ++hits;
            EXPECT_NEAR(first[i].t, 1, 1e-5 / cosine);
            const double c = std::pow(10.0, -4 * uniform(rng)) * (uniform(rng) < 0.5 ? -1 : 1);
            const dvec3 n = glm::normalize(dvec3(first[i].ng));
            leaving[i].leave =
                vec3(c * n + std::sqrt(1 - c * c) * glm::normalize(glm::cross(n, random_direction(rng))));
        }
        EXPECT_GT(hits, int(rays.size()) * 95 / 100);
        int again = 0;
        const auto second = ask_shapes(*device, device_scene, leaving);
        for (size_t i = 0; i < rays.size(); ++i) again += leaving[i].leave != rays[i].leave && second[i].again;
        EXPECT_EQ(again, 0);
    }
}

}  // namespace
}  // namespace lampyris::test

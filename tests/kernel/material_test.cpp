// From records to Bsdfs: slots and their textures, mixes, bump and normal maps, opacity; on every backend.
#include "support/texture_scene.h"

#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lampyris::test {
namespace {

constexpr const char* kFile = "kernel/material_probe.kernel.h";

struct Probe {
    glm::uvec4 what;
    glm::vec4 position, ng, ns, dpdu, dpdv, dndu, dndv, uv, wo;
};
struct Answer {
    glm::uvec4 what;
    glm::vec4 color0, color1, albedo, alpha, coat, frame_x, frame_z;
};

// A point of the plane z = 0, spanned by dpdu and dpdv.
Probe on_plane(uint32_t material, glm::vec2 uv = {0.3f, 0.6f}, glm::vec3 dpdu = {1, 0, 0}, glm::vec3 dpdv = {0, 1, 0}) {
    Probe p{};
    p.what.x = material;
    p.position = glm::vec4(uv.x * dpdu + uv.y * dpdv, 0);
    p.ng = p.ns = {0, 0, 1, 0};
    p.dpdu = glm::vec4(dpdu, 0);
    p.dpdv = glm::vec4(dpdv, 0);
    p.uv = {uv, 0, 0};
    p.wo = {0, 0.6f, 0.8f, 0};
    return p;
}

// The displacement at + a u + b v, as a program.
uint32_t add_ramp(TextureScene& scene, float at, float a, float b) {
    return scene.add_program({constant_op(glm::vec3(at)), constant_op(glm::vec3(at + b)),
                              constant_op(glm::vec3(at + a)), constant_op(glm::vec3(at + a + b)),
                              operation(kernel::TEXTURE_BILERP)});
}

glm::vec3 xyz(glm::vec4 v) { return glm::vec3(v); }
void expect_near(glm::vec3 got, glm::dvec3 want, double tolerance) {
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(got[c], want[c], tolerance)
            << "got " << got.x << " " << got.y << " " << got.z << ", want " << want.x << " " << want.y << " " << want.z;
}

// Every kind of material with known parameters.
std::vector<kernel::MaterialRecord> all_materials() {
    TextureScene scene;
    for (uint32_t kind = kernel::MATERIAL_INTERFACE; kind <= kernel::MATERIAL_COATEDCONDUCTOR; ++kind)
        for (uint32_t flags :
             {0u, kernel::MATERIAL_REMAP | kernel::MATERIAL_REMAP_COAT | kernel::MATERIAL_ENERGY_COMPENSATION,
              kernel::MATERIAL_USES_REFLECTANCE}) {
            const bool is_conductor = kind == kernel::MATERIAL_CONDUCTOR || kind == kernel::MATERIAL_COATEDCONDUCTOR;
            if (flags == kernel::MATERIAL_USES_REFLECTANCE && !is_conductor) continue;
            kernel::MaterialRecord& m = scene.add_material(kind, flags);
            m.color0 = {0.2f, 0.5f, 0.7f};
            m.scale = 0.9f;
            m.color1 = {0.3f, 0.6f, 0.8f};
            m.color2 = {0.1f, 0.4f, 0.9f};
            m.roughness_u = 0.25f;
            m.roughness_v = 0.36f;
            m.eta = 1.5f;
            m.g = 0.3f;
            m.thickness = 0.05f;
            m.coat_roughness_u = 0.16f;
            m.coat_roughness_v = 0.49f;
            m.max_depth = 7;
            m.samples = 3;
        }
    return scene.scene.materials;
}

TEST(Material, ParametersArriveAsTheModelsWantThem) {
    TextureScene scene;
    scene.scene.materials = all_materials();
    std::vector<Probe> probes;
    for (uint32_t i = 0; i < scene.scene.materials.size(); ++i) probes.push_back(on_plane(i));
    for (const std::string& backend : backend_names()) {
        const std::vector<Answer> got = scene.run<Answer>(backend, kFile, probes);
        for (size_t i = 0; i < got.size(); ++i) {
            const kernel::MaterialRecord& m = scene.scene.materials[i];
            const Answer& a = got[i];
            SCOPED_TRACE(testing::Message() << backend << ", kind " << m.kind << ", flags " << m.flags);
            EXPECT_EQ(a.what.x, m.kind);
            EXPECT_EQ(a.what.y, i);
            const bool remap = (m.flags & kernel::MATERIAL_REMAP) != 0;
            const glm::vec2 alpha = remap ? glm::vec2(0.5f, 0.6f) : glm::vec2(0.25f, 0.36f);
            const glm::vec2 coat = remap ? glm::vec2(0.4f, 0.7f) : glm::vec2(0.16f, 0.49f);
            const bool on_metal = m.kind == kernel::MATERIAL_COATEDCONDUCTOR;
            const bool is_conductor = m.kind == kernel::MATERIAL_CONDUCTOR || on_metal;
            glm::dvec3 color0(rgb_of(m.color0)), color1(rgb_of(m.color1));
            if (m.flags & kernel::MATERIAL_USES_REFLECTANCE) {
                // (eta - 1)^2 + k^2 over (eta + 1)^2 + k^2 is the reflectance at normal incidence; eta = 1.
                for (int c = 0; c < 3; ++c) color1[c] = std::sqrt(4 * color0[c] / (1 - color0[c]));
                color0 = glm::dvec3(1);
            }
            if (on_metal) color0 /= 1.5, color1 /= 1.5;
            if (m.kind == kernel::MATERIAL_DIFFUSETRANSMISSION) color0 *= 0.9f, color1 *= 0.9f;
            const bool has_color = is_conductor || m.kind == kernel::MATERIAL_DIFFUSE ||
                                   m.kind == kernel::MATERIAL_DIFFUSETRANSMISSION ||
                                   m.kind == kernel::MATERIAL_COATEDDIFFUSE;
            if (has_color) expect_near(xyz(a.color0), color0, 1e-6);
            if (is_conductor || m.kind == kernel::MATERIAL_DIFFUSETRANSMISSION)
                expect_near(xyz(a.color1), color1, 1e-6);
            const bool is_coat = on_metal || m.kind == kernel::MATERIAL_COATEDDIFFUSE;
            if (is_coat) {
                expect_near(xyz(a.albedo), glm::dvec3(rgb_of(m.color2)), 0);
                EXPECT_EQ(a.coat.x, 1.5f);
                EXPECT_EQ(a.coat.y, 0.05f);
                EXPECT_EQ(a.coat.z, 0.3f);
                EXPECT_EQ(a.what.w, 7u);
            }
            const glm::vec2 interface_alpha = on_metal ? coat : alpha;
            if (is_coat || m.kind == kernel::MATERIAL_CONDUCTOR || m.kind == kernel::MATERIAL_DIELECTRIC) {
                EXPECT_NEAR(a.alpha.x, interface_alpha.x, 1e-6);
                EXPECT_NEAR(a.alpha.y, interface_alpha.y, 1e-6);
            }
            if (on_metal) {
                EXPECT_NEAR(a.alpha.z, alpha.x, 1e-6);
                EXPECT_NEAR(a.alpha.w, alpha.y, 1e-6);
            }
            if (is_conductor) {
                EXPECT_EQ(a.what.z & kernel::MATERIAL_ENERGY_COMPENSATION,
                          m.flags & kernel::MATERIAL_ENERGY_COMPENSATION);
            }
            EXPECT_EQ(xyz(a.frame_z), glm::vec3(0, 0, 1));
        }
    }
}

// A slot with a texture gives the same Bsdf as one with that value.
TEST(Material, TexturesReplaceConstants) {
    TextureScene scene;
    const std::vector<kernel::MaterialRecord> constant = all_materials();
    scene.scene.materials = constant;
    for (kernel::MaterialRecord m : constant) {
        const auto color = [&](kernel::Spectrum s) { return scene.add_program({constant_op(rgb_of(s))}); };
        const auto number = [&](float x) { return scene.add_program({constant_op(glm::vec3(x))}); };
        m.color0_texture = color(m.color0);
        m.color1_texture = color(m.color1);
        m.color2_texture = color(m.color2);
        m.roughness_u_texture = number(m.roughness_u);
        m.roughness_v_texture = number(m.roughness_v);
        m.thickness_texture = number(m.thickness);
        m.coat_roughness_u_texture = number(m.coat_roughness_u);
        m.coat_roughness_v_texture = number(m.coat_roughness_v);
        m.color0 = m.color1 = m.color2 = {0.01f, 0.02f, 0.03f};
        m.roughness_u = m.roughness_v = m.thickness = m.coat_roughness_u = m.coat_roughness_v = 0.9f;
        scene.scene.materials.push_back(m);
    }
    std::vector<Probe> probes;
    for (uint32_t i = 0; i < scene.scene.materials.size(); ++i) probes.push_back(on_plane(i));
    for (const std::string& backend : backend_names()) {
        std::vector<Answer> got = scene.run<Answer>(backend, kFile, probes);
        std::vector<Answer> textured(got.begin() + ptrdiff_t(constant.size()), got.end());
        got.resize(constant.size());
        for (size_t i = 0; i < got.size(); ++i) textured[i].what.y = got[i].what.y;
        EXPECT_TRUE(same_bits(got, textured)) << backend;
    }
}

// ---- Mixes -----------------------------------------------------------------------------------------------------------

// The share of points at which a mix shows its second material, against the amount: a two-sided test of a binomial with n = 100,000,
// at 5.3 standard deviations (1e-7 each); 5 amounts and 4 outcomes of a nested mix on each backend: below 1e-5 in all.
TEST(Material, MixesInProportion) {
    constexpr uint32_t kCount = 100000;
    constexpr double kDeviations = 5.33;
    TextureScene scene;
    for (int i = 0; i < 4; ++i) scene.add_material(kernel::MATERIAL_DIFFUSE);
    const auto add_mix = [&](uint32_t first, uint32_t second, float amount, uint32_t program) {
        kernel::MaterialRecord& m = scene.add_material(kernel::MATERIAL_MIX);
        m.amount = amount;
        m.amount_texture = program;
        m.first_material = first;
        m.second_material = second;
        return uint32_t(scene.scene.materials.size() - 1);
    };
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(-1, 1);
    const auto points = [&](uint32_t material) {
        std::vector<Probe> probes(kCount, on_plane(material));
        for (Probe& p : probes) {
            p.position = {uniform(random), uniform(random), 0, 0};
            p.wo = {uniform(random), uniform(random), 0.5f, 0};
        }
        return probes;
    };
    const auto expect_share = [&](const std::vector<Answer>& got, uint32_t material, double share) {
        double count = 0;
        for (const Answer& a : got) count += a.what.y == material;
        EXPECT_NEAR(count / kCount, share, kDeviations * std::sqrt(share * (1 - share) / kCount))
            << "material " << material;
    };
    for (const std::string& backend : backend_names()) {
        SCOPED_TRACE(backend);
        for (float amount : {0.0f, 0.1f, 0.5f, 0.75f, 1.0f})
            expect_share(scene.run<Answer>(backend, kFile, points(add_mix(0, 1, amount, kernel::NONE))), 1, amount);
        expect_share(scene.run<Answer>(backend, kFile,
                                       points(add_mix(2, 0, 0.9f, scene.add_program({constant_op(glm::vec3(0.25f))})))),
                     0, 0.25);
        const uint32_t outer =
            add_mix(add_mix(0, 1, 0.5f, kernel::NONE), add_mix(2, 3, 0.2f, kernel::NONE), 0.5f, kernel::NONE);
        const std::vector<Answer> nested = scene.run<Answer>(backend, kFile, points(outer));
        const double shares[] = {0.25, 0.25, 0.4, 0.1};
        for (uint32_t i = 0; i < 4; ++i) expect_share(nested, i, shares[i]);
    }
}

TEST(Material, MixIsTheSameForAllWhoAsk) {
    TextureScene scene;
    scene.add_material(kernel::MATERIAL_DIFFUSE);
    scene.add_material(kernel::MATERIAL_DIFFUSE);
    kernel::MaterialRecord& m = scene.add_material(kernel::MATERIAL_MIX);
    m.amount = 0.5f;
    m.second_material = 1;
    std::vector<Probe> probes;
    for (int i = 0; i < 1000; ++i) probes.push_back(on_plane(2, {float(i) * 0.001f, 0.5f}));
    std::vector<Answer> first;
    for (const std::string& backend : backend_names()) {
        const std::vector<Answer> got = scene.run<Answer>(backend, kFile, probes);
        if (first.empty()) first = got;
        EXPECT_TRUE(same_bits(first, got)) << backend;
    }
}

// ---- Bump and normal maps --------------------------------------------------------------------------------------------

// The plane z = a u + b v over a parallelogram: the gradient is that of a plane through three points.
TEST(Material, BumpOnAPlane) {
    TextureScene scene;
    std::vector<Probe> probes;
    std::vector<glm::dvec3> want;
    struct Case {
        float at, a, b;
        glm::vec3 dpdu, dpdv;
    };
    const Case cases[] = {{0, 0.5f, 0, {1, 0, 0}, {0, 1, 0}},
                          {0.2f, 0.5f, -0.25f, {2, 0, 0}, {0, 0.5f, 0}},
                          {0, -1, 2, {1, 1, 0}, {-1, 2, 0}},
                          {0.1f, 0.3f, 0.3f, {1, 0, 0}, {0.9f, 1, 0}},
                          {0, 0, 0, {1, 0, 0}, {0, 1, 0}},
                          {0, 1, 0.5f, {0, 1, 0}, {1, 0, 0}}};  // the last: v runs the other way round
    for (const Case& c : cases) {
        kernel::MaterialRecord& m = scene.add_material(kernel::MATERIAL_DIFFUSE);
        m.bump_texture = add_ramp(scene, c.at, c.a, c.b);
        probes.push_back(on_plane(uint32_t(scene.scene.materials.size() - 1), {0.3f, 0.6f}, c.dpdu, c.dpdv));
        glm::dvec3 normal = glm::normalize(
            glm::cross(glm::dvec3(c.dpdu) + glm::dvec3(0, 0, c.a), glm::dvec3(c.dpdv) + glm::dvec3(0, 0, c.b)));
        want.push_back(normal.z < 0 ? -normal : normal);
    }
    for (const std::string& backend : backend_names()) {
        const std::vector<Answer> got = scene.run<Answer>(backend, kFile, probes);
        // Differences of floats over a step of 5e-4: an error of 2^-24 / 5e-4 = 1.2e-4 for values near 1.
        for (size_t i = 0; i < got.size(); ++i) expect_near(xyz(got[i].frame_z), want[i], 5e-4);
    }
}

// On the side of a surface whose orientation is reversed, a bump is outward along the reversed normal.
TEST(Material, BumpOnAReversedPlane) {
    TextureScene scene;
    scene.add_material(kernel::MATERIAL_DIFFUSE).bump_texture = add_ramp(scene, 0, 0.5f, 0.25f);
    Probe p = on_plane(0);
    p.ng = p.ns = {0, 0, -1, 0};
    // The surface is at z = -(0.5 u + 0.25 v), seen from below.
    for (const std::string& backend : backend_names())
        expect_near(xyz(scene.run<Answer>(backend, kFile, std::vector<Probe>{p})[0].frame_z),
                    glm::normalize(glm::dvec3(-0.5, -0.25, -1)), 5e-4);
}

// A sphere with displacement d(phi) = c cos(phi) around its equator: the polar curve r(phi) = 1 + d has the normal r e_r - r' e_phi.
TEST(Material, BumpOnASphere) {
    TextureScene scene;
    const float c = 0.1f;
    // In space: x of the unit sphere's equator is cos(phi).
    TextureOp x = operation(kernel::TEXTURE_BILERP, kernel::MAPPING_PLANAR);
    x.m0 = {1, 0, 0, 0};
    scene.add_material(kernel::MATERIAL_DIFFUSE).bump_texture =
        scene.add_program({constant_op(glm::vec3(0)), constant_op(glm::vec3(0)), constant_op(glm::vec3(c)),
                           constant_op(glm::vec3(c)), x});
    std::vector<Probe> probes;
    std::vector<glm::dvec3> want;
    for (int i = 0; i < 16; ++i) {
        const double phi = 0.39 * i, cosine = std::cos(phi), sine = std::sin(phi);
        Probe p{};
        p.position = p.ng = p.ns = {cosine, sine, 0, 0};
        // u = phi / (2 pi), v = latitude / pi
        const double u = 2 * 3.14159265358979, v = 3.14159265358979;
        p.dpdu = p.dndu = glm::vec4(-u * sine, u * cosine, 0, 0);
        p.dpdv = p.dndv = glm::vec4(0, 0, v, 0);
        p.uv = {phi / u, 0.5, 0, 0};
        p.wo = p.ns;
        probes.push_back(p);
        const glm::dvec3 radial(cosine, sine, 0), tangent(-sine, cosine, 0);
        want.push_back(glm::normalize((1 + c * cosine) * radial + c * sine * tangent));
    }
    for (const std::string& backend : backend_names()) {
        const std::vector<Answer> got = scene.run<Answer>(backend, kFile, probes);
        for (size_t i = 0; i < got.size(); ++i) expect_near(xyz(got[i].frame_z), want[i], 5e-4);
    }
}

TEST(Material, NormalMap) {
    TextureScene scene;
    const glm::vec3 encoded(0.75f, 0.25f, 0.9f);
    std::vector<uint32_t> words;
    for (int p = 0; p < 4; ++p)
        for (int channel = 0; channel < 3; ++channel) words.push_back(std::bit_cast<uint32_t>(encoded[channel]));
    const uint32_t image =
        scene.add_image(words, 2, 2, kernel::TEXEL_RGB32F, kernel::WRAP_REPEAT, kernel::FILTER_BILINEAR);
    scene.add_material(kernel::MATERIAL_DIFFUSE).normal_map = image;
    const glm::dvec3 n = glm::normalize(2.0 * glm::dvec3(encoded) - 1.0);
    Probe turned = on_plane(0, {0.3f, 0.6f}, {0, 2, 0}, {-3, 0, 0});
    for (const std::string& backend : backend_names()) {
        const std::vector<Answer> got = scene.run<Answer>(backend, kFile, std::vector<Probe>{on_plane(0), turned});
        expect_near(xyz(got[0].frame_z), n, 1e-6);
        expect_near(xyz(got[1].frame_z), glm::dvec3(-n.y, n.x, n.z), 1e-6);  // x of the map along dpdu
    }
}

// The frame is orthonormal, and x lies along dpdu where roughness has a direction.
TEST(Material, Frames) {
    TextureScene scene;
    kernel::MaterialRecord& m = scene.add_material(kernel::MATERIAL_CONDUCTOR);
    m.color0 = kernel::Spectrum(1.0f);
    m.roughness_u = 0.1f;
    m.roughness_v = 0.4f;
    Probe p = on_plane(0, {0.3f, 0.6f}, {1, 2, 0}, {-3, 1, 0});
    p.ns = glm::vec4(glm::normalize(glm::vec3(0.1f, -0.2f, 1)), 0);
    for (const std::string& backend : backend_names()) {
        const Answer a = scene.run<Answer>(backend, kFile, std::vector<Probe>{p})[0];
        const glm::dvec3 z(a.frame_z), x(a.frame_x), dpdu(p.dpdu);
        expect_near(xyz(a.frame_z), glm::dvec3(p.ns), 0);
        expect_near(xyz(a.frame_x), glm::normalize(dpdu - z * glm::dot(z, dpdu)), 1e-6);
    }
}

TEST(Material, Opacity) {
    TextureScene scene;
    const uint32_t constant = scene.add_geometry(kernel::NONE, 0.25f);
    const uint32_t textured = scene.add_geometry(add_ramp(scene, 0, 1, 0), 1.0f);
    Probe a = on_plane(0), b = on_plane(0);
    a.what.y = constant;
    b.what.y = textured;
    for (const std::string& backend : backend_names()) {
        const std::vector<Answer> got = scene.run<Answer>(backend, kFile, std::vector<Probe>{a, b});
        EXPECT_EQ(got[0].coat.w, 0.25f);
        EXPECT_NEAR(got[1].coat.w, 0.3f, 1e-6);
    }
}

}  // namespace
}  // namespace lampyris::test

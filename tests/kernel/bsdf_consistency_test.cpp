// Relations between the functions of a BSDF, at every input, on every backend: samples agree with evaluation, values are
// reciprocal, refraction obeys Snell's law, and no result is ever infinite, NaN or negative.
#include "support/bsdf_probe.h"
#include "support/layer_simulation.h"

#include <gtest/gtest.h>

#include <random>

using namespace lampyris;
using namespace lampyris::test;
using glm::dvec3;

namespace {

vec3 random_direction(std::mt19937& random) {
    std::uniform_real_distribution<double> uniform;
    return direction(2 * uniform(random) - 1, 2 * kPi * uniform(random));
}

std::vector<BsdfProbe> rough_materials() {
    return {diffuse(0.5f),
            diffuse_transmission(0.3f, 0.6f),
            conductor(0.2f, 3, 0.3f, 0.3f),
            conductor(1.5f, 2, 0.7f, 0.1f),
            conductor(0.2f, 3, 0.02f, 0.02f),
            conductor(0.2f, 3, 0.001f, 0.001f),
            dielectric(1.5f, 0.3f, 0.3f),
            dielectric(1.5f, 0.05f, 0.4f),
            dielectric(0.75f, 0.2f, 0.2f),
            dielectric(1.5f, 0.001f, 0.001f),
            dielectric(1.01f, 0.1f, 0.1f)};
}

// The directions of a sample are rounded to floats, so that a lobe as narrow as alpha changes by about 1e-7 / alpha between
// the normal that was sampled and the one that follows from the directions; much more where a weak refraction magnifies it.
double tolerance(const BsdfProbe& p) {
    double alpha = p.alpha.x > 0 ? std::min(p.alpha.x, p.alpha.y) : 1;
    double refraction = p.kind.x == kernel::MATERIAL_DIELECTRIC ? 3 / std::abs(double(p.coat.x) - 1) : 1;
    return 1e-4 + 4e-6 / alpha * refraction;
}

TEST(BsdfConsistency, SamplesSayWhatEvaluationSays) {
    for (const std::string& backend : kernel_backends()) {
        for (size_t i = 0; i < rough_materials().size(); ++i) {
            for (double c : {0.95, 0.4, 0.05, -0.7, -0.1}) {
                for (uint transport : {kRadiance, kImportance}) {
                    BsdfProbe probe = rough_materials()[i];
                    probe.wo = vec4(direction(c, 4), 0);
                    probe.what.z = transport;
                    size_t found = 0, far = 0;
                    for (const ProbeSample& s : BsdfProber::on(backend).sample(probe, 2000)) {
                        if (!s.found()) continue;
                        ++found;
                        double f = s.f_eta.x, pdf = s.pdf(), t = tolerance(probe);
                        bool near = std::abs(f - s.eval.x) <= t * f && std::abs(pdf - s.eval.w) <= t * pdf;
                        if (!near) ++far;
                        EXPECT_EQ(s.wi().z * probe.wo.z > 0, s.lobe() % 4 == kReflection);
                    }
                    EXPECT_GT(found, 900u) << backend << ", material " << i << " at cosine " << c;
                    EXPECT_EQ(far, 0u) << backend << ", material " << i << " at cosine " << c;
                }
            }
        }
    }
}

// The density of the other direction is the one with which a path from the other end, which transports the other quantity,
// samples it; of a diffuse surface that is |wo.z| / pi.
TEST(BsdfConsistency, DensitiesOfBothDirections) {
    std::mt19937 random(11);
    std::vector<vec4> pairs, swapped;
    for (int i = 0; i < 2000; ++i) {
        const vec4 a(random_direction(random), 0), b(random_direction(random), 0);
        pairs.insert(pairs.end(), {a, b});
        swapped.insert(swapped.end(), {b, a});
    }
    for (const std::string& backend : kernel_backends()) {
        BsdfProber& prober = BsdfProber::on(backend);
        for (size_t m = 0; m < rough_materials().size(); ++m) {
            for (const uint transport : {kRadiance, kImportance}) {
                SCOPED_TRACE(backend + ", material " + std::to_string(m));
                BsdfProbe probe = rough_materials()[m], other = probe;
                probe.what.z = transport, other.what.z = 1 - transport;
                const auto both = prober.run(Probe::both, {probe}, pairs, pairs.size() / 2, 2);
                const auto there = prober.run(Probe::eval, {probe}, pairs, pairs.size() / 2, 1);
                const auto back = prober.run(Probe::eval, {other}, swapped, pairs.size() / 2, 1);
                for (size_t i = 0; i < pairs.size() / 2; ++i) {
                    EXPECT_EQ(both[2 * i], there[i]);
                    EXPECT_EQ(both[2 * i + 1].w, back[i].w);
                    if (m > 0 || there[i].w == 0) continue;
                    EXPECT_NEAR(both[2 * i + 1].w, std::abs(pairs[2 * i].z) / kPi, 1e-6);
                }
            }
        }
    }
}

// f(wo, wi) of radiance is f(wi, wo) of importance. For the same pair of directions, importance is eta^2 times radiance for
// refracted light (eta: relative index of wi's side), and equal to it for reflected light.
TEST(BsdfConsistency, ValuesAreReciprocal) {
    std::mt19937 random(5);
    std::vector<vec4> pairs, swapped;
    for (int i = 0; i < 4000; ++i) {
        vec4 a(random_direction(random), 0), b(random_direction(random), 0);
        pairs.insert(pairs.end(), {a, b});
        swapped.insert(swapped.end(), {b, a});
    }
    for (const std::string& backend : kernel_backends()) {
        BsdfProber& prober = BsdfProber::on(backend);
        for (size_t m = 0; m < rough_materials().size(); ++m) {
            BsdfProbe probe = rough_materials()[m];
            probe.what.z = kRadiance;
            std::vector<vec4> radiance = prober.eval(probe, pairs);
            probe.what.z = kImportance;
            std::vector<vec4> importance = prober.eval(probe, pairs), back = prober.eval(probe, swapped);
            size_t positive = 0;
            for (size_t i = 0; i < radiance.size(); ++i) {
                double f = radiance[i].x, t = 10 * tolerance(probe) * f + 1e-12;
                positive += f > 0;
                EXPECT_NEAR(back[i].x, f, t) << backend << ", material " << m;
                double scale = 1;
                if (probe.kind.x == kernel::MATERIAL_DIELECTRIC && pairs[2 * i].z * pairs[2 * i + 1].z < 0)
                    scale = std::pow(double(probe.coat.x), pairs[2 * i].z > 0 ? 2 : -2);
                EXPECT_NEAR(importance[i].x, f * scale, t * scale) << backend << ", material " << m;
            }
            EXPECT_GT(positive, 500u) << "material " << m;
        }
    }
}

TEST(BsdfConsistency, SpecularDirectionsAndSharesAreExact) {
    std::mt19937 random(6);
    std::vector<vec4> inputs;
    std::vector<BsdfProbe> probes;
    std::uniform_real_distribution<double> uniform;
    for (float eta : {1.5f, 0.6f, 1.0f, 1.0002f, 3.0f})
        for (int i = 0; i < 500; ++i) {
            double c = i % 5 == 0 ? std::pow(10, -4 * uniform(random)) : 1 - uniform(random);
            vec3 wo = direction(i % 2 ? c : -c, 6 * uniform(random));
            if (std::abs(wo.z) < 1e-5f) continue;
            probes.push_back(dielectric(eta, 0, 0));
            inputs.insert(inputs.end(), {vec4(wo, float(uniform(random))), vec4(0, 0, 1, float(i % 3 == 0)),
                                         vec4(0.3f, 0.6f, 0, 0), vec4(0)});
        }
    for (const std::string& backend : kernel_backends()) {
        auto samples = BsdfProber::samples(BsdfProber::on(backend).run(Probe::everything, probes, inputs, 1, 4));
        for (size_t i = 0; i < samples.size(); ++i) {
            const ProbeSample& s = samples[i];
            dvec3 wo(inputs[4 * i]), wi(s.wi());
            double eta = probes[i].coat.x, relative = wo.z > 0 ? eta : 1 / eta, uc = inputs[4 * i].w;
            double r = fresnel_reflectance(std::abs(wo.z), relative, 0);
            double sin2 = (1 - wo.z * wo.z) / (relative * relative);
            if (std::abs(uc - r) < 1e-5 || std::abs(1 - sin2) < 1e-3) continue;
            std::string what = backend + ", index " + std::to_string(eta) + ", cosine " + std::to_string(wo.z);
            ASSERT_TRUE(s.found()) << what;
            bool reflected = uc < r, importance = inputs[4 * i + 1].w != 0;
            double share = reflected ? r : 1 - r;
            EXPECT_EQ(s.lobe(), kSpecular + (reflected ? kReflection : kTransmission)) << what;
            EXPECT_NEAR(s.pdf(), share, 5e-5) << what;
            EXPECT_NEAR(s.f_eta.w, reflected ? 1 : relative, 1e-6 * relative) << what;
            EXPECT_NEAR(s.weight(), reflected || importance ? 1 : 1 / (relative * relative),
                        1e-5 * (1 + 1 / (relative * relative)))
                << what;
            double scale = reflected ? 1 : relative, cos_t = reflected ? std::abs(wo.z) : std::sqrt(1 - sin2);
            EXPECT_NEAR(wi.x, -wo.x / scale, 1e-5) << what;
            EXPECT_NEAR(wi.y, -wo.y / scale, 1e-5) << what;
            EXPECT_NEAR(wi.z, (wo.z > 0) == reflected ? cos_t : -cos_t, 2e-5) << what;
            EXPECT_EQ(s.eval, vec4(0)) << "nothing is found by chance";
        }
    }
}

TEST(BsdfConsistency, ConductorFresnelMatchesComplexArithmetic) {
    for (const std::string& backend : kernel_backends()) {
        std::vector<BsdfProbe> probes;
        std::vector<vec4> inputs;
        for (float n : {0.0f, 0.05f, 0.2f, 1.0f, 1.5f, 5.0f})
            for (float k : {0.0f, 0.01f, 1.0f, 4.0f, 200.0f})
                for (double c : {1.0, 0.9, 0.5, 0.1, 0.01, 1e-4}) {
                    if (n + k == 0) continue;
                    probes.push_back(conductor(n, k, 0, 0));
                    inputs.insert(inputs.end(),
                                  {vec4(direction(c, 1), 0.5f), vec4(0, 0, 1, 0), vec4(0.3f, 0.6f, 0, 0), vec4(0)});
                }
        auto samples = BsdfProber::samples(BsdfProber::on(backend).run(Probe::everything, probes, inputs, 1, 4));
        for (size_t i = 0; i < samples.size(); ++i) {
            double n = probes[i].color0.x, k = probes[i].color1.x, c = inputs[4 * i].z;
            double f = fresnel_reflectance(c, n, k);
            if (f == 0) continue;
            EXPECT_NEAR(samples[i].weight(), f, 2e-5) << backend << ": " << n << " + " << k << " i at cosine " << c;
        }
    }
}

// Any parameters, any directions, any random numbers: results are finite and not negative.
TEST(BsdfConsistency, NothingDivergesForAnyInput) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform;
    auto pick = [&](std::initializer_list<double> values) { return float(values.begin()[random() % values.size()]); };
    auto alpha = [&] { return pick({0, 1e-5, 1e-3, 1.0001e-3, 0.01, 0.3, 1, 1, 50, 1e30, uniform(random)}); };
    auto share = [&] { return pick({0, 1, 0.5, 2, -1, uniform(random), 1e30}); };
    auto any_direction = [&]() -> vec3 {
        vec3 w = random_direction(random);
        switch (random() % 6) {
            case 0: w.z *= pick({1e-8, 1e-6, 1e-4, 0}); return glm::normalize(w);
            case 1: return vec3(0, 0, pick({1, -1}));
            case 2:
                w.x *= 1e-4f;
                w.y *= 1e-4f;
                return glm::normalize(w);
            default: return w;
        }
    };
    std::vector<BsdfProbe> probes;
    std::vector<vec4> inputs;
    for (uint i = 0; i < 60000; ++i) {
        BsdfProbe p;
        p.kind = {random() % 8,
                  random() % 2 * kernel::MATERIAL_ENERGY_COMPENSATION + random() % 2 * kernel::MATERIAL_EXACT_COAT,
                  random() % 20, random() % 3};
        bool index = p.kind.x == kernel::MATERIAL_CONDUCTOR || p.kind.x == kernel::MATERIAL_COATEDCONDUCTOR;
        for (int c = 0; c < 3; ++c) {
            p.color0[c] = index ? pick({0, 0.2, 1, 1.5, 40, 1e20, uniform(random)}) : share();
            p.color1[c] = index ? pick({0, 0, 3, 100, 1e20, uniform(random)}) : share();
            p.albedo[c] = random() % 2 ? 0 : share();
        }
        p.alpha = {alpha(), alpha(), alpha(), alpha()};
        p.coat = {pick({1.5, 1, 0, -1, 1.0001, 1.00011, 0.9998, 1.001, 2.4, 0.5, 1e-10, 1e10}),
                  pick({0, 0.01, 1, 1e-30, 1e30, -1}), pick({0, 0.5, -0.9, 1, -1, 5, 1e-3, 1e-5}), 0};
        vec3 wo = any_direction(), wi = any_direction();
        if (random() % 8 == 0) wi = -wo;
        if (random() % 8 == 0) wi = wo;
        if (random() % 8 == 0) wi = vec3(-wo.x, -wo.y, wo.z);
        auto number = [&] {
            return pick({0, 1 - 0x1p-24, 0x1p-24, 0.5, uniform(random) * 0.999, uniform(random) * 0.999});
        };
        probes.push_back(p);
        inputs.insert(inputs.end(),
                      {vec4(wo, number()), vec4(wi, float(random() % 2)), vec4(number(), number(), 0, 0), vec4(0)});
    }
    for (const std::string& backend : kernel_backends()) {
        auto samples = BsdfProber::samples(BsdfProber::on(backend).run(Probe::everything, probes, inputs, 1, 4));
        std::map<uint, size_t> found;
        size_t wrong = 0;
        for (size_t i = 0; i < samples.size(); ++i) {
            const ProbeSample& s = samples[i];
            bool fine = true;
            for (int c = 0; c < 4; ++c) fine = fine && std::isfinite(s.eval[c]) && s.eval[c] >= 0;
            if (s.found()) {
                ++found[probes[i].kind.x];
                for (int c = 0; c < 4; ++c)
                    fine = fine && std::isfinite(s.wi_pdf[c]) && std::isfinite(s.f_eta[c]) && s.f_eta[c] >= 0;
                double cosine = std::abs(double(s.wi_pdf.z));
                fine = fine && s.pdf() > 0 && cosine > 0 && std::abs(glm::length(dvec3(s.wi())) - 1) < 1e-4;
                fine = fine && std::isfinite(float(s.f_eta.x * cosine / s.pdf())) &&
                       std::isfinite(s.f_eta.x / float(s.pdf()));
            }
            if (!fine && ++wrong < 5) {
                ADD_FAILURE() << backend << ", case " << i << ", kind " << probes[i].kind.x << ": wi " << s.wi().x
                              << " " << s.wi().y << " " << s.wi().z << " pdf " << s.pdf() << " f " << s.f_eta.x
                              << " eval " << s.eval.x << " " << s.eval.w;
            }
        }
        EXPECT_EQ(wrong, 0u) << backend;
        for (uint kind = 1; kind < 8; ++kind) EXPECT_GT(found[kind], 1000u) << backend << ", kind " << kind;
        EXPECT_EQ(found[kernel::MATERIAL_INTERFACE], 0u);
    }
}

}  // namespace

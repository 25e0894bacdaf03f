// The material of docs/material-guide.md, which is not part of Lampyris, in a kernel of its own (tests/CMakeLists.txt), on
// every backend: samples follow the density and agree with evaluation, values are reciprocal, no energy is created.
//
// False alarms: the statistical test fails by chance with probability below kFalseAlarm in all (Bonferroni's correction over
// cases and backends). Streams are seeded, so that a run that passed passes again.
#include "support/bsdf_chi_squared.h"

#include <gtest/gtest.h>

#include <random>

namespace lampyris::test {
namespace {

constexpr double kFalseAlarm = 1e-6;
constexpr double kCosines[] = {1, 0.7, 0.1, -0.4};

BsdfProber& prober(const std::string& backend) {
    return BsdfProber::on(backend, "guide/guide_probe.kernel.h", kernel::EFFECT_OREN_NAYAR);
}

BsdfProbe clay(float reflectance, float roughness, double cosine) {
    BsdfProbe p;
    p.kind.x = kernel::MATERIAL_ORENNAYAR;
    p.color0 = vec4(reflectance);
    p.alpha.x = roughness;  // the record's slot
    p.wo = vec4(direction(cosine, 0.8), 0);
    return p;
}

// The share of light that leaves the surface, by a midpoint rule over f cos.
double energy(const std::string& backend, const BsdfProbe& probe) {
    constexpr int kZ = 200, kPhi = 200;
    std::vector<vec4> wi;
    for (int i = 0; i < kZ; ++i)
        for (int j = 0; j < kPhi; ++j)
            wi.push_back(vec4(direction(2 * (i + 0.5) / kZ - 1, 2 * kPi * (j + 0.5) / kPhi), 0));
    const std::vector<vec4> f = prober(backend).eval_at_wo(probe, wi);
    double sum = 0;
    for (size_t i = 0; i < wi.size(); ++i) sum += double(f[i].x) * std::abs(double(wi[i].z));
    return sum * 4 * kPi / (kZ * kPhi);
}

TEST(GuideMaterial, ReturnsTheEnergyThatItsSceneDerives) {
    for (const std::string& backend : kernel_backends())
        for (float roughness : {0.0f, 0.3f, 1.0f}) {
            // The rule's error is below 1e-4.
            EXPECT_NEAR(energy(backend, clay(1, roughness, 1)), kPi / (kPi + (kPi / 2 - 2.0 / 3) * roughness), 2e-4);
            for (double c : kCosines) EXPECT_LE(energy(backend, clay(1, roughness, c)), 1.0002) << backend << " " << c;
        }
}

TEST(GuideMaterial, ValuesAreReciprocal) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform;
    std::vector<vec4> pairs, swapped;
    for (int i = 0; i < 2000; ++i) {
        const vec4 a(direction(2 * uniform(random) - 1, 2 * kPi * uniform(random)), 0);
        const vec4 b(direction(2 * uniform(random) - 1, 2 * kPi * uniform(random)), 0);
        pairs.insert(pairs.end(), {a, b});
        swapped.insert(swapped.end(), {b, a});
    }
    for (const std::string& backend : kernel_backends()) {
        const auto there = prober(backend).eval(clay(0.8f, 0.7f, 1), pairs);
        const auto back = prober(backend).eval(clay(0.8f, 0.7f, 1), swapped);
        for (size_t i = 0; i < there.size(); ++i) EXPECT_NEAR(there[i].x, back[i].x, 1e-5 * (1e-3 + there[i].x));
    }
}

TEST(GuideMaterial, SamplesFollowTheDensityAndSayWhatEvaluationSays) {
    const std::vector<std::string> backends = kernel_backends();
    const double level = kFalseAlarm / double(std::size(kCosines) * backends.size());
    for (const std::string& backend : backends)
        for (double c : kCosines) {
            const BsdfProbe probe = clay(0.8f, 0.7f, c);
            const ChiSquaredResult r = chi_squared(prober(backend), probe, probe);
            EXPECT_GE(r.p, level) << backend << ", cosine " << c << ": chi^2 " << r.statistic << r.impossible;
            for (const ProbeSample& s : prober(backend).sample(probe, 2000)) {
                if (!s.found()) continue;
                EXPECT_NEAR(s.f_eta.x, s.eval.x, 1e-5 * s.eval.x);
                EXPECT_NEAR(s.pdf(), s.eval.w, 1e-5 * s.eval.w);
            }
        }
}

}  // namespace
}  // namespace lampyris::test

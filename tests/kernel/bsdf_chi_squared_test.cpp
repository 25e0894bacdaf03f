// Directions sampled from every material follow its density, on every backend: chi-squared tests. (Not the layered ones:
// their density is approximate by design.)
//
// False alarms: the tests of this file fail by chance with probability below kFalseAlarm in all (Bonferroni's correction over
// cases and backends). Streams are seeded, so that a run that passed passes again.
#include "support/bsdf_chi_squared.h"

#include <gtest/gtest.h>

using namespace lampyris;
using namespace lampyris::test;

namespace {

constexpr double kFalseAlarm = 2.5e-6;

struct Case {
    std::string name;
    BsdfProbe probe;
};

std::vector<Case> cases() {
    std::vector<Case> all;
    auto add = [&](const std::string& name, BsdfProbe probe, std::initializer_list<double> cosines) {
        for (double c : cosines) {
            probe.wo = vec4(direction(c, 0.8), 0);
            probe.what.y = uint(100 + all.size());
            all.push_back({name + " from cosine " + std::to_string(c), probe});
        }
    };
    add("diffuse", diffuse(0.5f), {0.7, -0.3});
    add("diffuse transmission", diffuse_transmission(0.3f, 0.6f), {0.7, -0.3});
    add("conductor, alpha 0.2", conductor(0.2f, 3, 0.2f, 0.2f), {0.9, 0.3, -0.6});
    add("conductor, alpha 0.6", conductor(0.2f, 3, 0.6f, 0.6f), {0.8, 0.05});
    add("conductor, anisotropic", conductor(0.2f, 3, 0.5f, 0.15f), {0.7, -0.2});
    add("glass, alpha 0.3", dielectric(1.5f, 0.3f, 0.3f), {0.9, 0.2, -0.9, -0.4});
    add("glass, alpha 0.8", dielectric(1.5f, 0.8f, 0.8f), {0.6, -0.1});
    add("glass, anisotropic", dielectric(1.33f, 0.2f, 0.6f), {0.5, -0.5});
    add("bubble, alpha 0.4", dielectric(0.7f, 0.4f, 0.4f), {0.6, -0.6});
    return all;
}

TEST(BsdfChiSquared, SamplesFollowTheDensity) {
    std::vector<Case> all = cases();
    std::vector<std::string> backends = kernel_backends();
    double level = kFalseAlarm / double(all.size() * backends.size());
    for (const std::string& backend : backends) {
        for (const Case& c : all) {
            ChiSquaredResult r = chi_squared(BsdfProber::on(backend), c.probe, c.probe);
            EXPECT_GE(r.p, level) << backend << ", " << c.name << ": chi^2 " << r.statistic << " with " << r.dof
                                  << " dof, p = " << r.p << r.impossible;
            EXPECT_GT(r.dof, 20) << c.name;
        }
    }
}

// The power of the test above: densities that are slightly wrong are rejected.
TEST(BsdfChiSquared, RejectsWrongDensities) {
    double level = kFalseAlarm / double(cases().size() * kernel_backends().size());
    BsdfProber& prober = BsdfProber::on(kernel_backends().front());
    auto p_of = [&](BsdfProbe sampled, BsdfProbe density) {
        sampled.wo = density.wo = vec4(direction(0.7, 1), 0);
        return chi_squared(prober, sampled, density).p;
    };
    EXPECT_LT(p_of(conductor(0.2f, 3, 0.2f, 0.2f), conductor(0.2f, 3, 0.215f, 0.215f)), level);
    EXPECT_LT(p_of(conductor(0.2f, 3, 0.5f, 0.15f), conductor(0.2f, 3, 0.15f, 0.5f)), level);
    EXPECT_LT(p_of(dielectric(1.5f, 0.3f, 0.3f), dielectric(1.57f, 0.3f, 0.3f)), level);
    EXPECT_LT(p_of(diffuse_transmission(0.3f, 0.6f), diffuse_transmission(0.33f, 0.6f)), level);
}

}  // namespace

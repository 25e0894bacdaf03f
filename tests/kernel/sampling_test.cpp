// Every sampling routine against its density, on every backend: chi-squared tests.
//
// False alarms: the tests of this file fail by chance with probability below kFalseAlarm in all (Bonferroni's correction over
// cases and backends). Streams are seeded, so that a run that passed passes again.
#include "core/device/kernel_types.h"
#include "support/device_run.h"
#include "support/histogram.h"

#include <gtest/gtest.h>

using namespace lampyris;
using namespace lampyris::test;
using glm::dvec2;
using glm::vec4;

namespace {

constexpr double kFalseAlarm = 2.5e-6;
constexpr double kPi = std::numbers::pi;
constexpr uint32_t kSamples = 200000;

struct SamplingProbe {
    glm::uvec4 what{0};
    vec4 a{0}, direction{0, 0, 1, 0};
};

struct Case {
    const char* name;
    uint32_t function;
    vec4 a;
    vec4 direction;
    Domain domain;
    int nx, ny, sub;
};

Domain interval(double low, double high) {
    return {high - low, [=](vec4 p) { return dvec2((double(p.x) - low) / (high - low), 0.5); },
            [=](dvec2 s) { return vec4(float(low + s.x * (high - low)), 0, 0, 0); }};
}
Domain square() {
    return {1, [](vec4 p) { return dvec2(p.x, p.y); }, [](dvec2 s) { return vec4(float(s.x), float(s.y), 0, 0); }};
}
// The square's coordinates: r^2 and the angle.
Domain disk() {
    return {kPi,
            [](vec4 p) {
                double phi = std::atan2(double(p.y), double(p.x)) / (2 * kPi);
                return dvec2(double(p.x) * p.x + double(p.y) * p.y, phi < 0 ? phi + 1 : phi);
            },
            [](dvec2 s) {
                return vec4(std::sqrt(s.x) * std::cos(2 * kPi * s.y), std::sqrt(s.x) * std::sin(2 * kPi * s.y), 0, 0);
            }};
}
// Barycentric b0 and b1: (b0 + b1)^2, and b0's share of it.
Domain triangle() {
    return {0.5,
            [](vec4 p) {
                double sum = double(p.x) + p.y;
                return dvec2(sum * sum, sum > 0 ? p.x / sum : 0.5);
            },
            [](dvec2 s) {
                double sum = std::sqrt(s.x);
                return vec4(sum * s.y, sum * (1 - s.y), 1 - sum, 0);
            }};
}
vec4 towards(double cos_theta, double phi) {
    double s = std::sqrt(1 - cos_theta * cos_theta);
    return vec4(s * std::cos(phi), s * std::sin(phi), cos_theta, 0);
}

std::vector<Case> cases() {
    Domain sphere = sphere_domain();
    vec4 up(0, 0, 1, 0);
    return {
        {"disk", 0, {}, up, disk(), 20, 20, 2},
        {"triangle", 1, {}, up, triangle(), 20, 20, 2},
        {"cosine hemisphere", 2, {}, up, sphere, 20, 20, 8},
        {"uniform hemisphere", 3, {}, up, sphere, 20, 20, 4},
        {"uniform sphere", 4, {}, up, sphere, 20, 20, 4},
        {"wide cone", 5, vec4(0.5f), up, sphere, 40, 20, 4},
        {"Henyey-Greenstein forward", 6, vec4(0.6f), towards(-0.5, 2), sphere, 20, 20, 12},
        {"Henyey-Greenstein isotropic", 6, vec4(0.0f), towards(0.9, 1), sphere, 20, 20, 4},
        {"Henyey-Greenstein backward", 6, vec4(-0.4f), towards(0.3, 4), sphere, 20, 20, 12},
        {"visible normals", 7, vec4(0.3f), towards(0.6, 1), sphere, 40, 20, 24},
        {"visible normals, anisotropic", 7, vec4(0.6f, 0.15f, 0, 0), towards(0.4, 0.7), sphere, 80, 20, 24},
        {"visible normals, grazing", 7, vec4(0.4f), towards(0.02, 3), sphere, 40, 20, 24},
        {"linear", 8, vec4(0.2f, 3, 0, 0), up, interval(0, 1), 100, 1, 16},
        {"linear from zero", 8, vec4(0, 2, 0, 0), up, interval(0, 1), 100, 1, 16},
        {"bilinear", 9, vec4(1, 0.1f, 3, 0), up, square(), 20, 20, 8},
        {"tent", 10, vec4(1.5f), up, interval(-1.5, 1.5), 100, 1, 16},
        {"exponential", 11, vec4(2), up, interval(0, 8), 100, 1, 16},
    };
}

class SamplingProber {
 public:
    explicit SamplingProber(const std::string& backend)
        : device_(create_device(backend)),
          kernel_(device_->compile("kernel/sampling_probe.kernel.h", kernel::kAllEffects)) {}

    std::vector<vec4> run(const Case& c, bool densities, const std::vector<vec4>& points) {
        SamplingProbe probe;
        probe.what = glm::uvec4(c.function, 99, densities ? 1 : 0, 0);
        probe.a = c.a;
        probe.direction = c.direction;
        BufferHandle buffer = upload(*device_, points, "points");
        const NamedBuffer buffers[] = {{"probes", upload(*device_, std::vector{probe}, "probes")}, {"points", buffer}};
        device_->run(*kernel_, nullptr, buffers, 0, uint32_t(points.size()));
        return download<vec4>(buffer, points.size());
    }
    ChiSquaredResult test(const Case& sampled, const Case& density) {
        Histogram histogram{sampled.nx, sampled.ny};
        for (vec4 p : run(sampled, false, std::vector<vec4>(kSamples))) histogram.add(sampled.domain, p);
        auto expected =
            expected_counts(density.domain, density.nx, density.ny, density.sub, kSamples, [&](const auto& points) {
                std::vector<double> values;
                for (vec4 p : run(density, true, points)) values.push_back(p.w);
                return values;
            });
        return chi_squared_test(histogram.cells, expected);
    }

 private:
    std::unique_ptr<Device> device_;
    KernelHandle kernel_;
};

TEST(Sampling, FollowsItsDensity) {
    std::vector<Case> all = cases();
    double level = kFalseAlarm / double(all.size() * kernel_backends().size());
    for (const std::string& backend : kernel_backends()) {
        SamplingProber prober(backend);
        for (const Case& c : all) {
            ChiSquaredResult r = prober.test(c, c);
            EXPECT_GE(r.p, level) << backend << ", " << c.name << ": chi^2 " << r.statistic << " with " << r.dof
                                  << " dof, p = " << r.p << r.impossible;
            EXPECT_GT(r.dof, 5);
        }
    }
}

// The power of the test above: densities that are slightly wrong are rejected.
TEST(Sampling, TestRejectsWrongDensities) {
    std::vector<Case> all = cases();
    auto find = [&](const std::string& name) {
        for (const Case& c : all)
            if (name == c.name) return c;
        throw std::logic_error(name);
    };
    double level = kFalseAlarm / double(all.size() * kernel_backends().size());
    SamplingProber prober(kernel_backends().front());
    Case wrong = find("visible normals");
    wrong.a = vec4(0.31f);
    EXPECT_LT(prober.test(find("visible normals"), wrong).p, level);
    wrong = find("Henyey-Greenstein forward");
    wrong.a.x = 0.58f;
    EXPECT_LT(prober.test(find("Henyey-Greenstein forward"), wrong).p, level);
    wrong = find("linear");
    wrong.a.x = 0.25f;
    EXPECT_LT(prober.test(find("linear"), wrong).p, level);
    EXPECT_LT(prober.test(find("cosine hemisphere"), find("uniform hemisphere")).p, level);
}

TEST(Sampling, StatisticsMatchTables) {
    // Upper 5 % points for 1, 10 and 100 degrees of freedom (Abramowitz and Stegun, table 26.8), and of the normal distribution.
    EXPECT_NEAR(chi_squared_survival(3.841459, 1), 0.05, 1e-6);
    EXPECT_NEAR(chi_squared_survival(18.307038, 10), 0.05, 1e-6);
    EXPECT_NEAR(chi_squared_survival(124.342113, 100), 0.05, 1e-6);
    EXPECT_NEAR(normal_threshold(0.05), 1.959964, 1e-5);
}

}  // namespace

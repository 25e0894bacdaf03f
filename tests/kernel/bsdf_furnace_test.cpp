// Energy: lossless materials return all of it, and rough ones as much as an independent quadrature predicts, on every backend.
//
// False alarms: the statistical tests of this file fail by chance with probability below kFalseAlarm in all (Bonferroni's
// correction over comparisons and backends). Streams are seeded, so that a run that passed passes again.
#include "support/bsdf_probe.h"
#include "support/layer_simulation.h"

#include <gtest/gtest.h>

#include <complex>

using namespace lampyris;
using namespace lampyris::test;
using glm::dvec3;

namespace {

constexpr double kFalseAlarm = 2.5e-6;
constexpr size_t kSamples = 20000;

// ---- Directional albedo of GGX surfaces by quadrature, in double precision ----------------------------------------------

double lambda(dvec3 w, double ax, double ay) {
    return (std::sqrt(1 + (ax * ax * w.x * w.x + ay * ay * w.y * w.y) / (w.z * w.z)) - 1) / 2;
}

struct Albedo {
    double reflected = 0, transmitted = 0;
};

// An integral over microfacet normals m, each of which reflects wo to one wi: D(m) |wo.m| G2(wo, wi) / |wo.z|, times the
// Fresnel reflectance. A midpoint rule over the parameters of Walter et al. 2007, equations 35 and 36, in which D(m) m.z is
// constant; with u = 1 - s^2, because the weight has a root singularity at u = 1.
Albedo ggx_albedo(dvec3 wo, double ax, double ay, double n, double k, bool glass) {
    constexpr int kSteps = 400;
    Albedo albedo;
    double eta = n;
    dvec3 o = wo;
    if (wo.z < 0) {
        o = -wo;
        eta = 1 / n;
    }
    for (int i = 0; i < kSteps; ++i) {
        for (int j = 0; j < kSteps; ++j) {
            double s = (i + 0.5) / kSteps, u = 1 - s * s, phi = 2 * kPi * (j + 0.5) / kSteps;
            double r = std::sqrt(u / (1 - u));
            dvec3 m = glm::normalize(dvec3(ax * r * std::cos(phi), ay * r * std::sin(phi), 1));
            double c = glm::dot(o, m);
            if (c <= 0) continue;
            double f = fresnel_reflectance(c, glass ? eta : n, k);
            auto weight = [&](dvec3 w) {
                return 2 * s * c / (o.z * m.z) / (1 + lambda(o, ax, ay) + lambda(w, ax, ay)) /
                       (double(kSteps) * kSteps);
            };
            dvec3 reflected = 2 * c * m - o;
            if (reflected.z > 0) albedo.reflected += f * weight(reflected);
            double c2 = 1 - (1 - c * c) / (eta * eta);
            if (!glass || c2 <= 0) continue;
            dvec3 refracted = (c / eta - std::sqrt(c2)) * m - o / eta;
            if (refracted.z < 0) albedo.transmitted += (1 - f) * weight(refracted);
        }
    }
    return albedo;
}

// ---- What the kernels say -----------------------------------------------------------------------------------------------

struct Energy {
    Mean total, reflected, transmitted;
};

Energy sampled_energy(BsdfProber& prober, const BsdfProbe& probe) {
    Energy e;
    for (const ProbeSample& s : prober.sample(probe, kSamples)) {
        double w = s.found() ? s.weight() : 0;
        bool reflected = s.found() && s.wi_pdf.z * probe.wo.z > 0;
        e.total.add(w);
        e.reflected.add(reflected ? w : 0);
        e.transmitted.add(reflected ? 0 : w);
    }
    return e;
}

// The same by a midpoint rule over f cos, in z = t |t| and phi: values and sampling are tested separately.
double evaluated_energy(BsdfProber& prober, const BsdfProbe& probe) {
    constexpr int kT = 500, kPhi = 600;
    static std::vector<vec4> wi;
    static std::vector<double> weights;
    for (int i = wi.empty() ? 0 : kT; i < kT; ++i) {
        for (int j = 0; j < kPhi; ++j) {
            double t = 2 * (i + 0.5) / kT - 1;
            wi.push_back(vec4(direction(t * std::abs(t), 2 * kPi * (j + 0.5) / kPhi), 0));
            weights.push_back(2 * std::abs(t) * 2 / kT * 2 * kPi / kPhi);
        }
    }
    std::vector<vec4> f = prober.eval_at_wo(probe, wi);
    double sum = 0;
    for (size_t i = 0; i < wi.size(); ++i) sum += double(f[i].x) * std::abs(double(wi[i].z)) * weights[i];
    return sum;
}

// ---- Lossless materials -----------------------------------------------------------------------------------------------

TEST(BsdfFurnace, LosslessMaterialsReturnAllEnergy) {
    std::vector<BsdfProbe> lossless = {diffuse(1),
                                       diffuse_transmission(0.5f, 0.5f),
                                       diffuse_transmission(0.25f, 0.75f),
                                       dielectric(1.5f, 0, 0),
                                       dielectric(1 / 1.5f, 0, 0),
                                       dielectric(1, 0, 0),
                                       dielectric(1, 0.5f, 0.5f),
                                       dielectric(2.4f, 0, 0),
                                       thin_dielectric(1.5f),
                                       conductor(0, 1000, 0, 0)};
    std::vector<double> cosines = {1, 0.7, 0.2, 0.01, -0.9, -0.3};
    double z = normal_threshold(kFalseAlarm / 3 / double(lossless.size() * cosines.size() * kernel_backends().size()));
    for (const std::string& backend : kernel_backends()) {
        for (size_t i = 0; i < lossless.size(); ++i) {
            for (double c : cosines) {
                BsdfProbe probe = lossless[i];
                probe.wo = vec4(direction(c, 2), 0);
                probe.what = {0, uint(i), kImportance, 1};
                Energy e = sampled_energy(BsdfProber::on(backend), probe);
                EXPECT_NEAR(e.total.value(), 1, z * e.total.error() + 2e-5)
                    << backend << ", material " << i << " at cosine " << c;
            }
        }
    }
}

TEST(BsdfFurnace, SmoothGlassSharesByFresnel) {
    double z = normal_threshold(kFalseAlarm / 3 / double(12 * kernel_backends().size()));
    for (const std::string& backend : kernel_backends()) {
        for (float eta : {1.5f, 1.33f, 0.8f}) {
            for (double c : {0.95, 0.3, -0.8, -0.6}) {
                BsdfProbe probe = dielectric(eta, 0, 0);
                probe.wo = vec4(direction(c, 2), 0);
                Energy e = sampled_energy(BsdfProber::on(backend), probe);
                double relative = c < 0 ? 1 / double(eta) : double(eta);
                double r = fresnel_reflectance(std::abs(double(probe.wo.z)), relative, 0);
                EXPECT_NEAR(e.reflected.value(), r, z * std::sqrt(r * (1 - r) / kSamples) + 2e-6)
                    << backend << " " << eta << " " << c;
                // Radiance is compressed into the denser medium.
                double t = (1 - r) / (relative * relative);
                EXPECT_NEAR(e.transmitted.value(), t,
                            z * std::sqrt(r * (1 - r) / kSamples) / (relative * relative) + 2e-6);
            }
        }
    }
}

// ---- Rough materials ----------------------------------------------------------------------------------------------------

struct Rough {
    const char* name;
    BsdfProbe probe;
    double ax, ay, n, k;
    bool glass;
};

TEST(BsdfFurnace, RoughMaterialsMatchQuadrature) {
    std::vector<Rough> materials = {
        {"metal 0.1", conductor(0.2f, 3, 0.1f, 0.1f), 0.1, 0.1, 0.2, 3, false},
        {"metal 0.7", conductor(0.2f, 3, 0.7f, 0.7f), 0.7, 0.7, 0.2, 3, false},
        {"metal, anisotropic", conductor(1.5f, 2, 0.6f, 0.2f), 0.6, 0.2, 1.5, 2, false},
        {"mirror 0.5", conductor(0, 1000, 0.5f, 0.5f), 0.5, 0.5, 0, 1000, false},
        {"glass 0.2", dielectric(1.5f, 0.2f, 0.2f), 0.2, 0.2, 1.5, 0, true},
        {"glass 0.6", dielectric(1.5f, 0.6f, 0.6f), 0.6, 0.6, 1.5, 0, true},
    };
    std::vector<double> cosines = {0.95, 0.5, 0.1, -0.7};
    double z =
        normal_threshold(kFalseAlarm / 3 / double(2 * materials.size() * cosines.size() * kernel_backends().size()));
    for (const Rough& m : materials) {
        for (double c : cosines) {
            BsdfProbe probe = m.probe;
            probe.wo = vec4(direction(c, 0.6), 0);
            probe.what.z = kImportance;
            Albedo albedo = ggx_albedo(dvec3(probe.wo), m.ax, m.ay, m.n, m.k, m.glass);
            if (!m.glass && c < 0) albedo = ggx_albedo(-dvec3(probe.wo), m.ax, m.ay, m.n, m.k, false);
            for (const std::string& backend : kernel_backends()) {
                BsdfProber& prober = BsdfProber::on(backend);
                Energy e = sampled_energy(prober, probe);
                double slack = 5e-5;  // of the quadrature
                std::string what = backend + ", " + m.name + " at cosine " + std::to_string(c);
                EXPECT_NEAR(e.reflected.value(), albedo.reflected, z * e.reflected.error() + slack) << what;
                EXPECT_NEAR(e.transmitted.value(), albedo.transmitted, z * e.transmitted.error() + slack) << what;
                EXPECT_NEAR(evaluated_energy(prober, probe), albedo.reflected + albedo.transmitted, 2e-3) << what;
            }
        }
    }
}

// With compensation, a lossless rough mirror keeps its energy, except for the fit's error (0.0065 of 1 - E, over E >= 0.35).
// Without it, it loses the energy that single scattering loses.
TEST(BsdfFurnace, CompensationReturnsTheMissingEnergy) {
    for (const std::string& backend : kernel_backends()) {
        BsdfProber& prober = BsdfProber::on(backend);
        for (float alpha : {0.05f, 0.2f, 0.5f, 1.0f}) {
            for (double c : {1.0, 0.6, 0.25, 0.1}) {
                BsdfProbe probe = conductor(0, 1000, alpha, alpha);
                probe.wo = vec4(direction(c, 0.6), 0);
                double lossy = ggx_albedo(dvec3(probe.wo), alpha, alpha, 0, 1000, false).reflected;
                probe.kind.y = kernel::MATERIAL_ENERGY_COMPENSATION;
                Energy e = sampled_energy(prober, probe);
                double fit = 0.0065 / lossy + 0.002;
                EXPECT_NEAR(e.total.value(), 1, fit + 6 * e.total.error())
                    << backend << " " << alpha << " " << c << " lossy " << lossy;
                EXPECT_LT(lossy, alpha >= 0.5f ? 0.97 : 1.0001);
            }
        }
    }
}

}  // namespace

#include "support/layer_simulation.h"

#include <cmath>
#include <complex>

namespace lampyris::test {
using glm::dvec3;

double fresnel_reflectance(double cos_i, double n, double k) {
    std::complex<double> eta(n, k);
    std::complex<double> cos_t = std::sqrt(1.0 - (1 - cos_i * cos_i) / (eta * eta));
    if (k == 0 && 1 - cos_i * cos_i >= n * n) return 1;
    std::complex<double> s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    std::complex<double> p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return (std::norm(s) + std::norm(p)) / 2;
}

static double lambda(dvec3 w, double alpha) {
    double tan2 = (1 - w.z * w.z) / (w.z * w.z);
    return (std::sqrt(1 + alpha * alpha * tan2) - 1) / 2;
}
double smith_g2(dvec3 wo, dvec3 wi, double alpha) { return 1 / (1 + lambda(wo, alpha) + lambda(wi, alpha)); }

// A normal with density D(m) cos(m) (Walter et al. 2007, equations 35 and 36).
dvec3 LayerSimulation::microfacet(double alpha) {
    if (alpha < 1e-3) return {0, 0, 1};
    double u = uniform(), phi = 2 * kPi * uniform();
    double tan2 = alpha * alpha * u / (1 - u);
    double c = 1 / std::sqrt(1 + tan2), s = std::sqrt(1 - c * c);
    return {s * std::cos(phi), s * std::sin(phi), c};
}

// The weight of a microfacet chosen so: |wo.m| G2 / (|wo.z| m.z) (equation 41).
LayerSimulation::Event LayerSimulation::interface(dvec3 wo) {
    bool inside = wo.z < 0;
    dvec3 o = inside ? -wo : wo;
    double eta = inside ? 1 / l_.eta : l_.eta;
    dvec3 m = microfacet(l_.alpha);
    double c = glm::dot(o, m);
    if (c <= 0) return {};
    double r = fresnel_reflectance(c, eta, 0);
    Event e;
    e.transmitted = uniform() >= r;
    e.w = 2 * c * m - o;
    if (e.transmitted) e.w = (c / eta - std::sqrt(1 - (1 - c * c) / (eta * eta))) * m - o / eta;
    if ((e.w.z < 0) != e.transmitted || e.w.z == 0) return {};
    e.weight = l_.alpha < 1e-3 ? 1 : c * smith_g2(o, e.w, l_.alpha) / (o.z * m.z);
    if (inside) e.w = -e.w;
    return e;
}

LayerSimulation::Event LayerSimulation::base(dvec3 wo) {
    Event e;
    if (!l_.metal) {
        double r = std::sqrt(uniform()), phi = 2 * kPi * uniform();
        e.w = {r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - r * r)};
        e.weight = l_.reflectance;
        return e;
    }
    dvec3 m = microfacet(l_.base_alpha);
    double c = glm::dot(wo, m);
    e.w = 2 * c * m - wo;
    if (c <= 0 || e.w.z <= 0) return {};
    e.weight = fresnel_reflectance(c, l_.n, l_.k);
    if (l_.base_alpha >= 1e-3) e.weight *= c * smith_g2(wo, e.w, l_.base_alpha) / (wo.z * m.z);
    return e;
}

LayerMoments LayerSimulation::run(dvec3 wo, size_t count) {
    LayerMoments moments;
    for (size_t i = 0; i < count; ++i) {
        double weight = 1, left = 0;
        dvec3 w = -wo;  // of travel
        double z = l_.thickness;
        bool at_boundary = true;
        dvec3 exit{0, 0, 0};
        for (int depth = 0; weight > 0; ++depth) {
            Event e;
            if (!at_boundary) {  // the medium scatters: Henyey and Greenstein by inversion
                double u = uniform(), g = l_.g;
                double c = std::abs(g) < 1e-6 ? 1 - 2 * u
                                              : (1 + g * g - std::pow((1 - g * g) / (1 - g + 2 * g * u), 2)) / (2 * g);
                double s = std::sqrt(std::max(0.0, 1 - c * c)), phi = 2 * kPi * uniform();
                dvec3 a = glm::normalize(glm::cross(w, std::abs(w.x) < 0.5 ? dvec3(1, 0, 0) : dvec3(0, 1, 0)));
                w = s * std::cos(phi) * a + s * std::sin(phi) * glm::cross(w, a) + c * w;
                weight *= l_.albedo;
            } else {
                e = z > 0 ? interface(-w) : base(-w);
                weight *= e.weight;
                w = e.w;
            }
            if (weight == 0) break;
            if (at_boundary && z > 0 && w.z > 0) {
                left = weight;
                exit = w;
                break;
            }
            if (depth >= l_.max_depth) break;
            double distance = -std::log(1 - uniform());
            double next = z + distance * w.z;
            at_boundary = next <= 0 || next >= l_.thickness;
            if (l_.albedo == 0) {
                weight *= std::exp(-l_.thickness / std::abs(w.z));
                at_boundary = true;
            }
            z = at_boundary ? (w.z > 0 ? l_.thickness : 0) : next;
        }
        moments.albedo.add(left);
        moments.cosine.add(left * exit.z);
        moments.x.add(left * (exit.x + 1));
    }
    return moments;
}

}  // namespace lampyris::test

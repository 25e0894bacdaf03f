// A layered material, simulated in double precision and independently of the kernels: particles are traced from the eye through
// interface, medium and base, choosing microfacets by their projected area alone (not by visibility).
#pragma once

#include "support/bsdf_probe.h"
#include "support/statistics.h"

#include <random>

namespace lampyris::test {

struct Layers {
    double eta = 1.5, alpha = 0, thickness = 0.01, albedo = 0, g = 0;
    bool metal = false;
    double reflectance = 0.5;             // diffuse base
    double n = 1, k = 0, base_alpha = 0;  // metal, relative to the coat
    int max_depth = 100;
};

struct LayerMoments {
    Mean albedo;  // of light leaving
    Mean cosine;  // weighted by the cosine of leaving
    Mean x;       // weighted by x of the direction of leaving, plus 1
};

class LayerSimulation {
 public:
    LayerSimulation(const Layers& layers, uint64_t seed) : l_(layers), random_(seed) {}
    LayerMoments run(glm::dvec3 wo, size_t count);

 private:
    struct Event {
        glm::dvec3 w{0};
        double weight = 0;
        bool transmitted = false;
    };
    double uniform() { return std::uniform_real_distribution<double>()(random_); }
    Event interface(glm::dvec3 wo);
    Event base(glm::dvec3 wo);
    glm::dvec3 microfacet(double alpha);
    Layers l_;
    std::mt19937_64 random_;
};

// Fresnel's reflectance by complex arithmetic, the index n + ik below; 1 where k = 0 and nothing is transmitted.
double fresnel_reflectance(double cos_i, double n, double k);
// Smith's height-correlated G2 for GGX.
double smith_g2(glm::dvec3 wo, glm::dvec3 wi, double alpha);

}  // namespace lampyris::test

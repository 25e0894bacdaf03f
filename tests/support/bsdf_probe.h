// Host side of kernel/bsdf_probe.kernel.h: calls scattering functions on a backend.
#pragma once

#include "core/device/kernel_types.h"
#include "support/device_run.h"

#include <glm/glm.hpp>

#include <cmath>
#include <map>
#include <numbers>

namespace lampyris::test {

using glm::uvec4;
using glm::vec3;
using glm::vec4;
using kernel::uint;

inline constexpr uint kRadiance = 0, kImportance = 1;
inline constexpr uint kReflection = 1, kTransmission = 2, kSpecular = 16;
inline constexpr double kPi = std::numbers::pi;

// As in the kernel.
enum class Probe : uint { sample, eval, eval_at_wo, eval_uniform, everything, properties, both };
struct BsdfProbe {
    uvec4 what{0, 1, 0, 1};
    uvec4 kind{0, 0, 10, 1};
    vec4 color0{0}, color1{0}, albedo{0}, alpha{0};
    vec4 coat{1.5f, 0.01f, 0, 0};
    vec4 wo{0, 0, 1, 0};
};

struct ProbeSample {
    vec4 wi_pdf, f_eta, eval, rest;
    vec3 wi() const { return vec3(wi_pdf); }
    double pdf() const { return wi_pdf.w; }
    uint lobe() const { return uint(rest.x); }
    bool found() const { return rest.y != 0; }
    double weight() const { return double(f_eta.x) * std::abs(double(wi_pdf.z)) / double(wi_pdf.w); }  // red channel
};

inline vec3 direction(double cos_theta, double phi) {
    double s = std::sqrt(std::max(0.0, 1 - cos_theta * cos_theta));
    return vec3(float(s * std::cos(phi)), float(s * std::sin(phi)), float(cos_theta));
}

// A backend's device with the probe compiled, kept for all tests of a program, because Vulkan takes seconds to compile.
class BsdfProber {
 public:
    static BsdfProber& on(const std::string& backend, const std::string& file = "kernel/bsdf_probe.kernel.h",
                          kernel::EffectSet effects = kernel::kAllEffects) {
        static std::map<std::string, std::unique_ptr<BsdfProber>> probers;
        auto& prober = probers[backend + " " + file];
        if (!prober) prober.reset(new BsdfProber(backend, file, effects));
        return *prober;
    }

    std::vector<vec4> run(Probe operation, std::vector<BsdfProbe> probes, const std::vector<vec4>& inputs,
                          size_t per_probe, size_t results_each) {
        for (BsdfProbe& probe : probes) {
            probe.what.x = uint(operation);
            probe.what.w = uint(per_probe);
        }
        size_t count = per_probe * probes.size();
        BufferHandle results = device_->create_buffer(count * results_each * sizeof(vec4), "results");
        const NamedBuffer buffers[] = {{"probes", upload(*device_, probes, "probes")},
                                       {"inputs", upload(*device_, inputs, "inputs")},
                                       {"results", results}};
        device_->run(*kernel_, nullptr, buffers, 0, uint(count));
        return download<vec4>(results, count * results_each);
    }

    std::vector<ProbeSample> sample(const BsdfProbe& probe, size_t count) {
        return samples(run(Probe::sample, {probe}, {}, count, 4));
    }
    // Uniform directions and the values there: f in f_eta.
    std::vector<ProbeSample> uniform(const BsdfProbe& probe, size_t count) {
        return samples(run(Probe::eval_uniform, {probe}, {}, count, 4));
    }
    // f and pdf for each wi.
    std::vector<vec4> eval_at_wo(const BsdfProbe& probe, const std::vector<vec4>& wi) {
        return run(Probe::eval_at_wo, {probe}, wi, wi.size(), 1);
    }
    // f and pdf for each pair wo, wi.
    std::vector<vec4> eval(const BsdfProbe& probe, const std::vector<vec4>& pairs) {
        return run(Probe::eval, {probe}, pairs, pairs.size() / 2, 1);
    }

    static std::vector<ProbeSample> samples(const std::vector<vec4>& v) {
        std::vector<ProbeSample> s(v.size() / 4);
        for (size_t i = 0; i < s.size(); ++i) s[i] = {v[4 * i], v[4 * i + 1], v[4 * i + 2], v[4 * i + 3]};
        return s;
    }

 private:
    BsdfProber(const std::string& backend, const std::string& file, kernel::EffectSet effects)
        : device_(create_device(backend)), kernel_(device_->compile(file, effects)) {}

    std::unique_ptr<Device> device_;
    KernelHandle kernel_;
};

// ---- Materials to test ----------------------------------------------------------------------------------------------

inline BsdfProbe diffuse(float r) {
    BsdfProbe p;
    p.kind.x = kernel::MATERIAL_DIFFUSE;
    p.color0 = vec4(r);
    return p;
}
inline BsdfProbe diffuse_transmission(float r, float t) {
    BsdfProbe p;
    p.kind.x = kernel::MATERIAL_DIFFUSETRANSMISSION;
    p.color0 = vec4(r);
    p.color1 = vec4(t);
    return p;
}
inline BsdfProbe conductor(float n, float k, float alpha_x, float alpha_y) {
    BsdfProbe p;
    p.kind.x = kernel::MATERIAL_CONDUCTOR;
    p.color0 = vec4(n);
    p.color1 = vec4(k);
    p.alpha = vec4(alpha_x, alpha_y, 0, 0);
    return p;
}
inline BsdfProbe dielectric(float eta, float alpha_x, float alpha_y) {
    BsdfProbe p;
    p.kind.x = kernel::MATERIAL_DIELECTRIC;
    p.alpha = vec4(alpha_x, alpha_y, 0, 0);
    p.coat.x = eta;
    return p;
}
inline BsdfProbe thin_dielectric(float eta) {
    BsdfProbe p;
    p.kind.x = kernel::MATERIAL_THINDIELECTRIC;
    p.coat.x = eta;
    return p;
}
inline BsdfProbe coated_diffuse(float r, float eta, float alpha, float thickness, float albedo, float g) {
    BsdfProbe p;
    p.kind.x = kernel::MATERIAL_COATEDDIFFUSE;
    p.color0 = vec4(r);
    p.alpha = vec4(alpha, alpha, 0, 0);
    p.coat = vec4(eta, thickness, g, 0);
    p.albedo = vec4(albedo);
    p.kind.z = 100;
    return p;
}
inline BsdfProbe coated_conductor(float n, float k, float base_alpha, float eta, float alpha, float thickness,
                                  float albedo, float g) {
    BsdfProbe p = coated_diffuse(0, eta, alpha, thickness, albedo, g);
    p.kind.x = kernel::MATERIAL_COATEDCONDUCTOR;
    p.color0 = vec4(n);
    p.color1 = vec4(k);
    p.alpha = vec4(base_alpha, base_alpha, alpha, alpha);
    return p;
}

}  // namespace lampyris::test

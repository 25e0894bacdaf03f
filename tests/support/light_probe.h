// Runs tests/kernel/light_probe.kernel.h.
#pragma once

#include "support/device_run.h"
#include "support/test_scene.h"

namespace lampyris::test {

// Binary layout of LightProbe in the kernel.
struct LightProbe {
    glm::uvec4 what;
    glm::vec4 ref_p;
};

struct LightAnswer {
    glm::vec3 wi;
    float pdf;  // 0: no light was found
    float radiance;
    float distance;
    float pdf_met;  // light_pdf of the first thing that wi meets, and
    float distance_met;
};

struct DirectionAnswer {
    float radiance, pdf;  // pdf summed over all that the direction meets
    float distance, hits, pdf_first;
};

// The probe, for the effects given: compiled once, used with many scenes.
inline KernelHandle light_probe(Device& device, uint64_t effects) {
    return device.compile("kernel/light_probe.kernel.h", effects);
}

class LightAsker {
 public:
    LightAsker(Device& device, const KernelHandle& kernel, const Scene& scene)
        : device_(device), scene_(device.upload(scene)), kernel_(kernel) {}

    bool weighted = false;  // samples are weighed against those of a BSDF
    std::vector<LightAnswer> sample(glm::vec3 ref_p, uint32_t count, uint32_t seed = 1) {
        const auto v = run({{0, seed, 0, weighted}, glm::vec4(ref_p, 0)}, {glm::vec4(0)}, count);
        std::vector<LightAnswer> answers(count);
        for (uint32_t i = 0; i < count; ++i)
            answers[i] = {glm::vec3(v[2 * i]), v[2 * i].w,     v[2 * i + 1].x,
                          v[2 * i + 1].y,      v[2 * i + 1].z, v[2 * i + 1].w};
        return answers;
    }
    std::vector<DirectionAnswer> look(glm::vec3 ref_p, const std::vector<glm::vec4>& directions, uint32_t light = 0) {
        const auto v = run({{1, 0, light, weighted}, glm::vec4(ref_p, 0)}, directions, uint32_t(directions.size()));
        std::vector<DirectionAnswer> answers(directions.size());
        for (size_t i = 0; i < directions.size(); ++i)
            answers[i] = {v[2 * i].x, v[2 * i].w, v[2 * i + 1].x, v[2 * i + 1].y, v[2 * i + 1].z};
        return answers;
    }

 private:
    std::vector<glm::vec4> run(const LightProbe& probe, const std::vector<glm::vec4>& inputs, uint32_t count) {
        const BufferHandle what = upload(device_, std::vector{probe}, "probe");
        const BufferHandle in = upload(device_, inputs, "inputs");
        const BufferHandle out = device_.create_buffer(size_t(count) * 2 * sizeof(glm::vec4), "results");
        const NamedBuffer buffers[] = {{"probe", what}, {"inputs", in}, {"results", out}};
        device_.run(*kernel_, scene_.get(), buffers, 0, count);
        return download<glm::vec4>(out, size_t(count) * 2);
    }

    Device& device_;
    DeviceSceneHandle scene_;
    KernelHandle kernel_;
};

}  // namespace lampyris::test

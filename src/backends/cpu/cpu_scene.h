// A scene as the CPU backend holds it: pointers into the host's arrays, and a ray tracer.
#pragma once

#include "core/device/device.h"
#include "core/device/kernel_registry.h"
#include "core/device/kernel_types.h"

#include <array>
#include <memory>
#include <vector>

namespace lampyris {

class Bvh2Scene;
class Bvh2Walk;
class EmbreeScene;
struct SceneBuffer;

enum class CpuTracerKind { embree, bvh2 };

class CpuScene final : public DeviceScene {
 public:
    static constexpr size_t kBufferCount = kernel::SCENE_BINDINGS;
    CpuScene(const Scene& scene, CpuTracerKind tracer, bool watertight);
    ~CpuScene() override;
    void set_camera(const kernel::CameraRecord& camera) override { record_.camera = camera; }
    void* const* buffers() const { return buffers_.data(); }
    const CpuTracer& tracer() const { return tracer_; }
    // Whether the tracer could not follow some ray to its end since the last call.
    bool take_unfinished() const;
    size_t memory_bytes() const { return memory_; }
    const EmbreeScene* embree() const { return embree_.get(); }

 private:
    void bind(const std::vector<SceneBuffer>& buffers);

    std::array<void*, kBufferCount> buffers_{};  // by binding
    kernel::SceneRecord record_{};               // what kernels read, instead of the scene's or the BVH's
    std::unique_ptr<EmbreeScene> embree_;        // of backend cpu
    std::unique_ptr<Bvh2Scene> bvh_;             // of backend cpu-bvh2
    std::unique_ptr<Bvh2Walk> walk_;             // of its rays
    CpuTracer tracer_;
    size_t memory_ = 0;
};

}  // namespace lampyris

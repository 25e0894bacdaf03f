#include "backends/cpu/cpu_scene.h"

#include "accel/rays/bvh2.h"
#include "accel/rays/bvh2_walk.h"
#include "accel/rays/embree_scene.h"

namespace lampyris {

CpuScene::CpuScene(const Scene& scene, CpuTracerKind tracer, bool watertight) {
    if (tracer == CpuTracerKind::bvh2) {
        bvh_ = std::make_unique<Bvh2Scene>(scene);
        bind(bvh_->buffers());
        walk_ = std::make_unique<Bvh2Walk>(buffers_.data());
        tracer_ = walk_->tracer();
        memory_ = bvh_->bvh().bytes();
        return;
    }
    bind(scene_buffers(scene));
    embree_ = std::make_unique<EmbreeScene>(scene, buffers_.data(), watertight);
    tracer_ = embree_->tracer();
    memory_ = embree_->memory_bytes();
}

CpuScene::~CpuScene() = default;

bool CpuScene::take_unfinished() const { return walk_ && walk_->take_unfinished(); }

void CpuScene::bind(const std::vector<SceneBuffer>& buffers) {
    // Kernels read these arrays in place; none writes to the scene.
    for (const SceneBuffer& buffer : buffers) buffers_[buffer.binding] = const_cast<void*>(buffer.data);
    record_ = *static_cast<const kernel::SceneRecord*>(buffers_[kernel::BINDING_RECORD]);
    buffers_[kernel::BINDING_RECORD] = &record_;
}

}  // namespace lampyris

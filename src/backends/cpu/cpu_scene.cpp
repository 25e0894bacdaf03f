#include "backends/cpu/cpu_scene.h"

#include "backends/cpu/embree_scene.h"
#include "core/bvh/bvh2.h"
#include "core/scene/scene.h"

namespace lampyris {
namespace {

// Kernels read these arrays in place; none writes to the scene.
template <typename T>
void* data_of(const std::vector<T>& array) {
    return const_cast<T*>(array.data());
}

}  // namespace

// The BVH2, and the scene's records that name its roots.
struct CpuScene::OwnBvh {
    Bvh2 bvh;
    kernel::SceneRecord record;
    std::vector<kernel::InstanceRecord> instances;
};

CpuScene::CpuScene(const Scene& scene, CpuTracerKind tracer) {
    // In the order of core/kernel/bindings.h.
    void* const arrays[] = {const_cast<kernel::SceneRecord*>(&scene.record),
                            data_of(scene.geometries),
                            data_of(scene.indices),
                            data_of(scene.positions),
                            data_of(scene.normals),
                            data_of(scene.uvs),
                            data_of(scene.transforms),
                            data_of(scene.instances),
                            data_of(scene.materials),
                            data_of(scene.texture_ops),
                            data_of(scene.images),
                            data_of(scene.texels),
                            data_of(scene.lights),
                            data_of(scene.distributions)};
    std::copy(std::begin(arrays), std::end(arrays), buffers_.begin());
    buffers_[18] = data_of(scene.media);
    if (tracer == CpuTracerKind::bvh2) {
        bvh_ = std::make_unique<OwnBvh>(OwnBvh{build_bvh2(scene), scene.record, scene.instances});
        bvh_->record.root_node = bvh_->bvh.roots[0];
        for (size_t i = 0; i < bvh_->instances.size(); ++i) bvh_->instances[i].data.z = bvh_->bvh.roots[i];
        buffers_[0] = &bvh_->record;
        buffers_[7] = bvh_->instances.data();
        buffers_[14] = bvh_->bvh.nodes.data();
        buffers_[15] = bvh_->bvh.triangles.data();
        memory_ = bvh_->bvh.bytes();
        return;
    }
    embree_ = std::make_unique<EmbreeScene>(scene, buffers_.data());
    tracer_ = embree_->tracer();
    memory_ = embree_->memory_bytes();
}

CpuScene::~CpuScene() = default;

}  // namespace lampyris

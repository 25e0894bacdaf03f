#include "backends/cpu/cpu_scene.h"

#include "backends/cpu/embree_scene.h"
#include "core/scene/scene.h"

#include <stdexcept>

namespace lampyris {
namespace {

// Kernels read these arrays in place; none writes to the scene.
template <typename T>
void* data_of(const std::vector<T>& array) {
    return const_cast<T*>(array.data());
}

}  // namespace

CpuScene::CpuScene(const Scene& scene, CpuTracerKind tracer) {
    // In the order of core/kernel/bindings.h.
    void* const arrays[] = {const_cast<kernel::SceneRecord*>(&scene.record), data_of(scene.geometries), data_of(scene.indices),
                            data_of(scene.positions), data_of(scene.normals), data_of(scene.uvs), data_of(scene.transforms),
                            data_of(scene.instances), data_of(scene.materials), data_of(scene.texture_ops), data_of(scene.images),
                            data_of(scene.texels), data_of(scene.lights), data_of(scene.distributions)};
    std::copy(std::begin(arrays), std::end(arrays), buffers_.begin());
    if (tracer != CpuTracerKind::embree) throw std::logic_error("the BVH2 tracer is not built");
    embree_ = std::make_unique<EmbreeScene>(scene, buffers_.data());
    tracer_ = embree_->tracer();
    memory_ = embree_->memory_bytes();
}

CpuScene::~CpuScene() = default;

}  // namespace lampyris

// The BVH2 that kernels traverse themselves (core/kernel/trace_bvh2.h): on Vulkan, and on the CPU as backend cpu-bvh2.
#pragma once

#include "core/device/kernel_types.h"
#include "core/scene/scene_buffers.h"

#include <cstdint>
#include <vector>

namespace lampyris {

struct Bvh2 {
    std::vector<kernel::BvhNode> nodes;
    std::vector<kernel::vec4>
        triangles;  // three per primitive, in the order of the leaves; see BVH_TRIANGLE in layout.h
    // Values for the scene's records: InstanceRecord::data.z of each instance; SceneRecord::root_node is the first.
    std::vector<uint32_t> roots;
    size_t bytes() const { return nodes.size() * sizeof(kernel::BvhNode) + triangles.size() * sizeof(kernel::vec4); }
};

// Builds with Embree's builder (binned SAH, leaves of up to four): one tree per geometry set; instances are leaves of the
// world's tree. Primitives with coordinates that are not finite are left out, as Embree does.
// Throws MachineError if there is not enough memory, or if there are more primitives than a leaf can address.
Bvh2 build_bvh2(const Scene& scene);

// A scene with its BVH2: the scene's buffers, except that those which hold the BVH's roots are replaced. The scene must outlive
// this.
class Bvh2Scene {
 public:
    explicit Bvh2Scene(const Scene& scene);
    const Bvh2& bvh() const { return bvh_; }
    std::vector<SceneBuffer> buffers() const;

 private:
    const Scene& scene_;
    Bvh2 bvh_;
    kernel::SceneRecord record_;
    std::vector<kernel::InstanceRecord> instances_;
};

}  // namespace lampyris

#include "core/device/cpp_kernel.h"
#include "core/photons/photon_map.h"
#include "accel/photons/bvh/bvh_params.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>

namespace lampyris {
namespace kernel {
namespace {

struct TreeCode {
#include "accel/photons/bvh/bvh_layout.h"
};

}  // namespace
}  // namespace kernel

namespace {

using TreeRecord = kernel::TreeCode::TreeRecord;

enum RayQuery : uint32_t { kAuto, kOn, kOff };

class Bvh : public PhotonMap {
 public:
    BvhParams params;
    PhotonMapCapabilities capabilities() const override {
        // A driver traverses boxes in an unspecified order, and always all that are hit.
        return {.exact = true,
                .fixed_order = params.ray_query == kOff,
                .k_nearest = params.ray_query != kOn,
                .boxes = params.ray_query == kOn};
    }
    // The access reads a photon.
    ConstructionTraffic traffic() const override { return {.accesses = 1, .sorted_bits = 32}; }

 protected:
    static constexpr const char* kCode = "accel/photons/bvh/bvh_code.kernel.h";
    static constexpr const char* kOrder = "accel/photons/bvh/bvh_order.kernel.h";
    static constexpr const char* kLeaves = "accel/photons/bvh/bvh_leaves.kernel.h";
    static constexpr const char* kLevel = "accel/photons/bvh/bvh_level.kernel.h";
    static constexpr const char* kBoxes = "accel/photons/bvh/bvh_boxes.kernel.h";
    bool ray_query() const {
        return params.ray_query == kOn || (params.ray_query == kAuto && device().offers(DeviceFeature::kRayQuery));
    }
    std::vector<std::string> gather_files() const override {
        return {ray_query() ? "bvh_ray_query.gather.h" : "bvh.gather.h"};
    }
    std::vector<std::string> kernels() const override {
        return {kCode, kOrder, kBoxes, kLeaves, kLevel, kRadixKernels[0], kRadixKernels[1]};
    }

    // Sets each level's range of boxes. Returns the number of boxes of all levels.
    uint32_t lay_out(TreeRecord& record) const {
        uint32_t boxes = 0, level = 0;
        for (uint32_t nodes = (record.count + params.leaf - 1) / params.leaf;; nodes = (nodes + 3) / 4) {
            record.levels[level++] = {boxes, nodes, 0, 0};
            boxes += nodes;
            if (nodes <= 1) break;
        }
        record.level_count = level;
        return boxes;
    }

    void construct(const PhotonSet& photons) override {
        const uint32_t count = photons.count;
        TreeRecord record{};
        record.radius.x = photons.radius;
        record.count = count;
        record.leaf_photons = params.leaf;
        const glm::vec3 extent = photons.high - photons.low;
        const float largest = std::max({extent.x, extent.y, extent.z, 0.0f});
        record.origin = glm::vec4(photons.low, largest > 0 && std::isfinite(largest) ? 1048576.0f / largest : 0.0f);
        const uint32_t boxes_count = lay_out(record);
        upload("tree", record);
        const BufferHandle pairs = keep("pairs", size_t(count) * 8), other = keep("pairs 2", size_t(count) * 8);
        keep("places", size_t(count) * 16);
        keep("fluxes", size_t(count) * 16);
        const BufferHandle boxes = keep("boxes", ray_query() ? size_t(count) * 24 : size_t(boxes_count) * 32);
        run(kCode, count);
        const BufferHandle sorted = radix_sort(pairs, other, count, 32);
        const BufferHandle order = sorted == pairs ? other : pairs;
        run(kOrder, batch_count(count), {{"pairs", sorted}, {"order", order}});
        if (ray_query()) {
            // In Morton order, the photons of neighbouring boxes are close in memory. Also, some drivers (Mesa 25's
            // lavapipe) do not sort boxes themselves.
            run(kBoxes, count);
            build_boxes(boxes, count);
            return;
        }
        run(kLeaves, record.levels[0].y);
        for (uint32_t level = 1; level < record.level_count; ++level) {
            record.built_level = level;
            upload("tree", record);
            run(kLevel, record.levels[level].y);
        }
    }
};

REGISTER_PHOTON_MAP(Bvh, BVH_PARAMS, "bvh", "A tree of boxes over photons in Morton order.")

}  // namespace
}  // namespace lampyris

#include "accel/rays/bvh2.h"

#include "core/base/error.h"
#include "core/scene/scene.h"
#include "accel/rays/embree_scene.h"
#include "accel/rays/primitive_kernel.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <new>
#include <span>

namespace lampyris {
namespace {

using kernel::BvhNode;
using kernel::vec3;
using kernel::vec4;

constexpr uint32_t kLeafBit = 0x80000000u;
constexpr uint32_t kMostPrimitives = 1u << 24;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr uint32_t kInstanceGeometry = 0xffffffffu;  // geomID of build primitives that are instances

struct Box {
    vec3 low{kInfinity}, high{-kInfinity};
    void extend(const vec3& p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    void extend(const Box& box) {
        low = glm::min(low, box.low);
        high = glm::max(high, box.high);
    }
    bool empty() const { return !(low.x <= high.x); }
    bool finite() const {
        // The limit is far above any valid coordinate. Beyond it, products of boxes and rays would overflow; Embree has the
        // same limit.
        constexpr float kMost = 1.844e18f;
        for (int i = 0; i < 3; ++i)
            if (!(low[i] >= -kMost) || !(high[i] <= kMost)) return false;
        return true;
    }
};

// The output of Embree's builder, before it is flattened. Allocated by the builder's thread-local allocator, never destroyed.
struct BuildNode {
    BuildNode* children[2] = {};
    Box boxes[2];
    const RTCBuildPrimitive* items = nullptr;  // only in leaves
    uint32_t count = 0;
};

void* create_node(RTCThreadLocalAllocator allocator, unsigned, void*) {
    return new (rtcThreadLocalAlloc(allocator, sizeof(BuildNode), alignof(BuildNode))) BuildNode;
}
void set_children(void* node, void** children, unsigned count, void*) {
    for (unsigned i = 0; i < count; ++i)
        static_cast<BuildNode*>(node)->children[i] = static_cast<BuildNode*>(children[i]);
}
void set_bounds(void* node, const RTCBounds** bounds, unsigned count, void*) {
    for (unsigned i = 0; i < count; ++i) {
        const RTCBounds& b = *bounds[i];
        static_cast<BuildNode*>(node)->boxes[i] = {{b.lower_x, b.lower_y, b.lower_z},
                                                   {b.upper_x, b.upper_y, b.upper_z}};
    }
}
void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* items, size_t count, void*) {
    auto* node = new (rtcThreadLocalAlloc(allocator, sizeof(BuildNode), alignof(BuildNode))) BuildNode;
    auto* copy = static_cast<RTCBuildPrimitive*>(
        rtcThreadLocalAlloc(allocator, count * sizeof(RTCBuildPrimitive), alignof(RTCBuildPrimitive)));
    std::copy_n(items, count, copy);
    node->items = copy;
    node->count = static_cast<uint32_t>(count);
    return node;
}

using EmbreeBvh = EmbreeObject<RTCBVH, rtcReleaseBVH>;

Box box_of(const RTCBuildPrimitive& item) {
    return {{item.lower_x, item.lower_y, item.lower_z}, {item.upper_x, item.upper_y, item.upper_z}};
}

vec3 vertex(const Scene& scene, const kernel::GeometryRecord& geometry, uint32_t corner) {
    const size_t i = 3 * (size_t(geometry.first_vertex) + scene.indices[size_t(geometry.first_index) + corner]);
    return {scene.positions[i], scene.positions[i + 1], scene.positions[i + 2]};
}

// A box that no ray hits: infinitely far away in every direction. (An inverted box would be hit, because the kernels' slab test
// sorts the planes.)
const Box kNowhere{vec3(kInfinity), vec3(kInfinity)};

void set_child(BvhNode& node, int side, uint32_t bits, const Box& box) {
    const float word = std::bit_cast<float>(bits);
    (side == 0 ? node.left_min : node.right_min) = vec4(box.low, 0.0f);
    (side == 0 ? node.left_max : node.right_max) = vec4(box.high, 0.0f);
    (side == 0 ? node.left_min : node.left_max).w = word;
}

class Builder {
 public:
    explicit Builder(const Scene& scene) : scene_(scene), device_(rtcNewDevice("start_threads=0")) {
        if (!device_.get()) throw MachineError("error: Embree cannot start on this processor");
    }

    Bvh2 build() {
        std::vector<uint32_t> set_roots(scene_.sets.size());
        std::vector<Box> set_boxes(scene_.sets.size());
        const size_t instances = scene_.instances.size();
        for (size_t set = scene_.sets.size(); set-- > 0;) {  // the world last: it needs the boxes of its instances
            std::vector<RTCBuildPrimitive> items = primitives_of(scene_.sets[set]);
            if (set == 0) {
                for (size_t i = 1; i < instances; ++i) {
                    const Box box = transformed(set_boxes[scene_.instance_sets[i]], scene_.instances[i].transform);
                    if (!box.empty() && box.finite()) items.push_back(make_item(box, kInstanceGeometry, uint32_t(i)));
                }
            }
            for (const RTCBuildPrimitive& item : items) set_boxes[set].extend(box_of(item));
            set_roots[set] = build_tree(items);
        }
        result_.roots.resize(std::max<size_t>(instances, 1));
        for (size_t i = 0; i < result_.roots.size(); ++i)
            result_.roots[i] = set_roots[i == 0 ? 0 : scene_.instance_sets[i]];
        return std::move(result_);
    }

 private:
    static RTCBuildPrimitive make_item(const Box& box, uint32_t geometry, uint32_t primitive) {
        RTCBuildPrimitive item;
        item.lower_x = box.low.x, item.lower_y = box.low.y, item.lower_z = box.low.z, item.geomID = geometry;
        item.upper_x = box.high.x, item.upper_y = box.high.y, item.upper_z = box.high.z, item.primID = primitive;
        return item;
    }

    // The box of a transformed box, enlarged for the rounding of hits that lie on it.
    static Box transformed(const Box& box, const kernel::TransformRecord& m) {
        Box result;
        if (box.empty()) return result;
        for (int corner = 0; corner < 8; ++corner) {
            const vec4 p(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                         corner & 4 ? box.high.z : box.low.z, 1.0f);
            result.extend(vec3(glm::dot(m.to0, p), glm::dot(m.to1, p), glm::dot(m.to2, p)));
        }
        const vec3 slack = 4e-6f * glm::max(glm::abs(result.low), glm::abs(result.high)) + 1e-30f;
        result.low -= slack;
        result.high += slack;
        return result;
    }

    std::vector<RTCBuildPrimitive> primitives_of(const GeometrySet& set) const {
        std::vector<RTCBuildPrimitive> items;
        size_t count = 0;
        for (uint32_t g = 0; g < set.geometry_count; ++g)
            count += scene_.geometries[set.first_geometry + g].primitive_count;
        items.reserve(count + 16);
        for (uint32_t g = set.first_geometry; g < set.first_geometry + set.geometry_count; ++g) {
            const kernel::GeometryRecord& geometry = scene_.geometries[g];
            const bool triangles = geometry.kind == kernel::GEOMETRY_TRIANGLES;
            const bool many = triangles || geometry.kind == kernel::GEOMETRY_BILINEAR;
            for (uint32_t p = 0; p < (many ? geometry.primitive_count : 1u); ++p) {
                Box box;
                if (triangles) {
                    for (uint32_t corner = 0; corner < 3; ++corner)
                        box.extend(vertex(scene_, geometry, 3 * p + corner));
                    // min and max ignore NaN, so test the sum of the coordinates, too.
                    for (uint32_t corner = 0; corner < 3; ++corner) {
                        const vec3 v = vertex(scene_, geometry, 3 * p + corner);
                        if (!std::isfinite(v.x + v.y + v.z)) box.high.x = kInfinity;
                    }
                } else {
                    const PrimitiveBounds bounds = primitive_bounds(scene_, g, p);
                    box = {bounds.low, bounds.high};
                }
                if (box.finite()) items.push_back(make_item(box, g, p));
            }
        }
        return items;
    }

    // Reserves room for all of a large tree at once, but not for each of many small trees: each reservation would copy
    // everything before it.
    template <typename T>
    static void make_room(std::vector<T>& values, size_t more) {
        if (values.size() + more > values.capacity())
            values.reserve(std::max(values.size() + more, values.capacity() + values.capacity() / 2));
    }

    uint32_t build_tree(std::vector<RTCBuildPrimitive>& items) {
        const auto root = static_cast<uint32_t>(result_.nodes.size());
        if (items.empty()) {
            // An empty tree gets a triangle without an area, which no ray hits. (If a child were the root itself, a traversal
            // might not end.)
            const uint32_t nothing = kLeafBit | 1u << 24 | uint32_t(result_.triangles.size() / 3);
            result_.triangles.insert(result_.triangles.end(), 3, vec4(0.0f));
            result_.nodes.emplace_back();
            for (int side = 0; side < 2; ++side) set_child(result_.nodes[root], side, nothing, kNowhere);
            return root;
        }
        const EmbreeBvh bvh(rtcNewBVH(device_.get()));
        RTCBuildArguments arguments = rtcDefaultBuildArguments();
        arguments.byteSize = sizeof arguments;
        arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
        arguments.maxBranchingFactor = 2;
        // A path through the world's tree and on through an object's must fit the kernels' stack.
        arguments.maxDepth = scene_.instances.size() > 1 ? kernel::BVH_DEPTH_INSTANCES : kernel::BVH_DEPTH;
        arguments.sahBlockSize = 1;
        arguments.minLeafSize = 1;
        arguments.maxLeafSize = 4;
        arguments.traversalCost = 1.0f;
        arguments.intersectionCost = 1.0f;
        arguments.bvh = bvh.get();
        arguments.primitives = items.data();
        arguments.primitiveCount = items.size();
        arguments.primitiveArrayCapacity = items.size();
        arguments.createNode = create_node;
        arguments.setNodeChildren = set_children;
        arguments.setNodeBounds = set_bounds;
        arguments.createLeaf = create_leaf;
        const auto* top = static_cast<const BuildNode*>(rtcBuildBVH(&arguments));
        if (!top)
            throw MachineError(
                fmt::format("error: no memory left while building a BVH of {} primitives", items.size()));
        if (result_.triangles.size() / 3 + items.size() > kMostPrimitives) {
            throw MachineError(fmt::format(
                "error: the BVH2 holds at most {} primitives; --backend cpu has no such limit", kMostPrimitives));
        }
        make_room(result_.nodes, items.size());
        make_room(result_.triangles, 3 * items.size());
        if (top->items) {  // a tree of a single leaf: a node whose other child no ray hits
            Box box;
            for (uint32_t i = 0; i < top->count; ++i) box.extend(box_of(top->items[i]));
            result_.nodes.emplace_back();
            const uint32_t bits = leaf_bits({top->items, top->count});
            set_child(result_.nodes[root], 0, bits, box);
            set_child(result_.nodes[root], 1, bits, kNowhere);
            return root;
        }
        flatten(*top);
        return root;
    }

    // Depth first, so that a child often lies next to its parent.
    uint32_t flatten(const BuildNode& node) {
        const auto index = static_cast<uint32_t>(result_.nodes.size());
        result_.nodes.emplace_back();
        for (int side = 0; side < 2; ++side) {
            const BuildNode& child = *node.children[side];
            const uint32_t bits = child.items ? leaf_bits({child.items, child.count}) : flatten(child);
            set_child(result_.nodes[index], side, bits, node.boxes[side]);
        }
        return index;
    }

    // Instances have leaves of their own (with a count of 0): a leaf with both kinds becomes a small tree.
    uint32_t leaf_bits(std::span<const RTCBuildPrimitive> items) {
        std::vector<RTCBuildPrimitive> sorted(items.begin(), items.end());
        const auto middle = std::partition(sorted.begin(), sorted.end(),
                                           [](const auto& item) { return item.geomID != kInstanceGeometry; });
        const auto plain = static_cast<size_t>(middle - sorted.begin());
        if (plain == sorted.size()) return primitives_leaf(sorted);
        if (sorted.size() == 1) return kLeafBit | sorted[0].primID;
        const size_t split = plain > 0 ? plain : sorted.size() / 2;
        const auto index = static_cast<uint32_t>(result_.nodes.size());
        result_.nodes.emplace_back();
        const std::span<const RTCBuildPrimitive> all(sorted), parts[2] = {all.first(split), all.subspan(split)};
        for (int side = 0; side < 2; ++side) {
            Box box;
            for (const RTCBuildPrimitive& item : parts[side]) box.extend(box_of(item));
            const uint32_t bits = leaf_bits(parts[side]);
            set_child(result_.nodes[index], side, bits, box);
        }
        return index;
    }

    uint32_t primitives_leaf(const std::vector<RTCBuildPrimitive>& items) {
        const auto first = static_cast<uint32_t>(result_.triangles.size() / 3);
        for (const RTCBuildPrimitive& item : items) {
            const kernel::GeometryRecord& geometry = scene_.geometries[item.geomID];
            vec3 v[3] = {};
            uint32_t kind = kernel::BVH_QUADRIC;
            if (geometry.kind == kernel::GEOMETRY_TRIANGLES) {
                kind = kernel::BVH_TRIANGLE;
                for (uint32_t corner = 0; corner < 3; ++corner)
                    v[corner] = vertex(scene_, geometry, 3 * item.primID + corner);
            } else if (geometry.kind == kernel::GEOMETRY_BILINEAR) {
                kind = kernel::BVH_BILINEAR;
            }
            result_.triangles.emplace_back(v[0], std::bit_cast<float>(item.geomID));
            result_.triangles.emplace_back(v[1], std::bit_cast<float>(item.primID));
            result_.triangles.emplace_back(v[2], std::bit_cast<float>(kind));
        }
        return kLeafBit | uint32_t(items.size()) << 24 | first;
    }

    const Scene& scene_;
    EmbreeDevice device_;
    Bvh2 result_;
};

}  // namespace

Bvh2 build_bvh2(const Scene& scene) {
    try {
        return Builder(scene).build();
    } catch (const std::bad_alloc&) {
        throw MachineError("error: no memory left while building the BVH2");
    }
}

Bvh2Scene::Bvh2Scene(const Scene& scene)
    : scene_(scene), bvh_(build_bvh2(scene)), record_(scene.record), instances_(scene.instances) {
    record_.root_node = bvh_.roots[0];
    for (size_t i = 0; i < instances_.size(); ++i) instances_[i].root_node = bvh_.roots[i];
}

std::vector<SceneBuffer> Bvh2Scene::buffers() const {
    std::vector<SceneBuffer> buffers = scene_buffers(scene_);
    for (SceneBuffer& buffer : buffers) {
        if (buffer.binding == kernel::BINDING_RECORD) buffer.data = &record_;
        if (buffer.binding == kernel::BINDING_INSTANCES) buffer.data = instances_.data();
    }
    buffers.push_back(scene_buffer(kernel::BINDING_BVH_NODES, bvh_.nodes, "BVH nodes"));
    buffers.push_back(scene_buffer(kernel::BINDING_BVH_TRIANGLES, bvh_.triangles, "BVH primitives"));
    return buffers;
}

}  // namespace lampyris

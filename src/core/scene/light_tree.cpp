#include "core/scene/light_tree.h"

#include "core/scene/light_bounds.h"
#include "core/scene/light_distribution.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace lampyris {
namespace {

// The part of a sphere around all lights that their areas may have.
constexpr double kDense = 0.1;
constexpr size_t kBuckets = 12;
constexpr int kDivided = 48;  // levels of the tree that are divided where it costs least

struct Leaf {
    uint32_t light;
    LightBounds bounds;
};

class LightTreeBuilder {
 public:
    LightTreeBuilder(Scene& scene, std::vector<Leaf> leaves) : scene_(scene), leaves_(std::move(leaves)) {
        for (const Leaf& leaf : leaves_) total_ += leaf.bounds.intensity;
        scene_.light_nodes.reserve(2 * leaves_.size() - 1);
        add(leaves_, 0);
        // They are in the order of the leaves now.
        std::vector<double> intensities;
        for (const Leaf& leaf : leaves_) intensities.push_back(leaf.bounds.intensity);
        scene_.record.tree_cdf = append_cdf(intensities, scene_.distributions);
        scene_.record.tree_leaves = uint32_t(leaves_.size());
        for (const Leaf& leaf : leaves_) {
            scene_.lights[leaf.light].distribution = uint32_t(&leaf - leaves_.data());
            scene_.distributions.push_back(leaf.light);
        }
    }

 private:
    LightBounds add(std::span<Leaf> leaves, int depth) {
        const size_t index = scene_.light_nodes.size();
        scene_.light_nodes.emplace_back();
        if (leaves.size() == 1) {
            scene_.light_nodes[index] = node_of(leaves[0].bounds, kernel::NONE);
            return leaves[0].bounds;
        }
        const size_t left = split(leaves, depth);
        const LightBounds a = add(leaves.first(left), depth + 1);
        const auto right = uint32_t(scene_.light_nodes.size());
        const LightBounds b = add(leaves.subspan(left), depth + 1);
        const LightBounds both = joined(a, b);
        scene_.light_nodes[index] = node_of(both, right);
        return both;
    }

    // Moves those that go to the left to the front; returns their number.
    static size_t split(std::span<Leaf> leaves, int depth) {
        if (leaves.size() == 2) return 1;
        glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
        for (const Leaf& leaf : leaves) {
            low = glm::min(low, leaf.bounds.middle());
            high = glm::max(high, leaf.bounds.middle());
        }
        const glm::dvec3 size = high - low;
        const double longest = std::max({size.x, size.y, size.z});
        // Halves end soon; other divisions may go on for as many levels as a double has digits.
        if (depth >= kDivided || !(longest > 0)) return leaves.size() / 2;
        constexpr size_t kMany = 256;  // of more, the longest axis is enough
        double least = std::numeric_limits<double>::infinity();
        int axis = 0;
        size_t after = 0;
        for (int i = 0; i < 3; ++i) {
            if (!(size[i] > 0) || (leaves.size() > kMany && size[i] < longest)) continue;
            std::array<LightBounds, kBuckets> buckets;
            for (const Leaf& leaf : leaves) {
                LightBounds& bucket = buckets[bucket_of(leaf, i, low, size)];
                bucket = joined(bucket, leaf.bounds);
            }
            std::array<double, kBuckets> of_right;
            LightBounds right;
            for (size_t k = kBuckets; k-- > 1;) of_right[k] = tree_cost(right = joined(buckets[k], right));
            LightBounds left;
            for (size_t k = 1; k < kBuckets; ++k) {
                left = joined(left, buckets[k - 1]);
                // Thin boxes are not to become thinner.
                const double cost = (tree_cost(left) + of_right[k]) * (longest / size[i]);
                if (cost < least) least = cost, axis = i, after = k;
            }
        }
        const auto middle = std::stable_partition(
            leaves.begin(), leaves.end(), [&](const Leaf& leaf) { return bucket_of(leaf, axis, low, size) < after; });
        const auto left = size_t(middle - leaves.begin());
        return left > 0 && left < leaves.size() ? left : leaves.size() / 2;
    }

    // The bounds are a little larger than the lights', by odd parts of their size: in a row of lamps, none is then between two
    // buckets, where rounding would decide, and with it the whole tree.
    static size_t bucket_of(const Leaf& leaf, int axis, const glm::dvec3& low, const glm::dvec3& size) {
        const double place = (leaf.bounds.middle()[axis] - low[axis]) / size[axis];
        return size_t(double(kBuckets) * (0.0137 + 0.9771 * place));
    }

    kernel::LightNode node_of(const LightBounds& bounds, uint32_t right) const {
        kernel::LightNode node{};
        node.middle = glm::vec3(bounds.middle());
        const glm::dvec3 half = 0.5 * (bounds.high - bounds.low);
        node.radius2 = float(glm::dot(half, half));
        node.axis = glm::vec3(bounds.axis);
        // No share is 0, so that there is always one to compare with.
        node.intensity = std::max(float(bounds.intensity / total_), std::numeric_limits<float>::min());
        node.cos_normals = float(std::cos(bounds.normals)), node.cos_emission = float(std::cos(bounds.emission));
        node.right = right;
        node.two_sided = bounds.two_sided ? 1u : 0u;
        return node;
    }

    Scene& scene_;
    std::vector<Leaf> leaves_;
    double total_ = 0;
};

}  // namespace

bool build_light_tree(Scene& scene, std::span<const double> powers) {
    const uint32_t first = scene.record.placeless_lights;
    std::vector<Leaf> leaves;
    for (uint32_t i = first; i < scene.lights.size(); ++i)
        if (powers[i] > 0) leaves.push_back({i, light_bounds(scene, scene.lights[i], powers[i])});
    if (leaves.size() < kFewestLightsOfTree) return false;
    // A lamp of many faces, or the walls of a box that shines, are one light to nearly all of the scene.
    LightBounds all;
    double area = 0;
    for (const Leaf& leaf : leaves) {
        all = joined(all, leaf.bounds);
        const glm::dvec3 size = leaf.bounds.high - leaf.bounds.low;
        area += 0.5 * glm::dot(size, size);
    }
    const glm::dvec3 half = 0.5 * (all.high - all.low);
    if (area > kDense * 4 * std::numbers::pi * glm::dot(half, half)) return false;
    scene.record.tree_share = kernel::CDF_TOTAL - scene.distributions[scene.record.light_cdf + first];
    LightTreeBuilder(scene, std::move(leaves));
    return true;
}

}  // namespace lampyris

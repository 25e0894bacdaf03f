#include "core/photon_map.h"
#include "accel/kd_tree/kd_tree.params.h"

#define KERNEL_TRACER_embree 1
#include "core/kernel/cpp_kernel.h"

#include <fmt/format.h>

#include <algorithm>

namespace lampyris {
namespace kernel {
namespace {

struct KdCode {
#include "accel/kd_tree/kd_tree.layout.h"
};

}  // namespace
}  // namespace kernel

namespace {

using kernel::KdCode;

class KdTree : public PhotonMap {
 public:
    KdTreeParams params;
    PhotonMapCapabilities capabilities() const override {
        return {.exact = true, .fixed_order = true, .k_nearest = true};
    }
    // Count, place and photon, for each round that a photon of the last build went through.
    ConstructionTraffic traffic() const override { return {.accesses = 2 * rounds_, .atomics = rounds_}; }

 protected:
    static constexpr const char* kList = "accel/kd_tree/kd_tree_list.kernel.h";
    static constexpr const char* kBound = "accel/kd_tree/kd_tree_bound.kernel.h";
    static constexpr const char* kShape = "accel/kd_tree/kd_tree_shape.kernel.h";
    static constexpr const char* kCount = "accel/kd_tree/kd_tree_count.kernel.h";
    static constexpr const char* kScatter = "accel/kd_tree/kd_tree_scatter.kernel.h";
    static constexpr const char* kLeaves = "accel/kd_tree/kd_tree_leaves.kernel.h";
    static constexpr const char* kLevels = "accel/kd_tree/kd_tree_levels.kernel.h";
    std::vector<std::string> kernels() const override {
        return {kList, kBound, kShape, kCount, kScatter, kLeaves, kLevels};
    }

    struct Round {
        uint32_t larges = 0, chunks = 0, cells = 0, levels = 0;  // `levels`: of the node that has most
        uint32_t first_node = 0;
    };

    // One of a round's buffers.
    const BufferHandle& keep_of(const char* what, size_t round, size_t bytes) {
        return keep(fmt::format("{} {}", what, round), bytes);
    }
    const BufferHandle& of(const char* what, size_t round) const { return kept(fmt::format("{} {}", what, round)); }
    BufferHandle arguments(const std::vector<Round>& rounds, size_t round, uint32_t step) {
        KdCode::KdArgs args{};
        args.sizes = glm::uvec4(photons_.count, params.leaf, round, rounds[round].cells / KdCode::KD_GROUP);
        args.nodes = glm::uvec4(rounds[round].first_node, rounds[round].first_node + rounds[round].cells, step, 0);
        return upload("arguments", args);
    }

    // The node that holds all photons. The set's box may be wrong: the next round's are not.
    Round open_root() {
        KdCode::KdLarge root{};
        root.photons = glm::uvec4(0, photons_.count, 0, 0);
        root.cells = glm::uvec4(0, KdCode().kd_levels(photons_.count, params.leaf), 0, 0);
        for (int axis = 0; axis < 3; ++axis) {
            root.least[axis] = ~KdCode().kd_ordered(photons_.low[axis]);
            root.greatest[axis] = KdCode().kd_ordered(photons_.high[axis]);
        }
        root.least.w = root.greatest.w = ~0u;
        KdCode().kd_shape(root, 0);
        keep_of("large nodes", 0, sizeof root)->upload(&root, sizeof root);
        keep_of("chunks", 0, 4);
        keep_of("owners", 0, 4);
        return {1, (photons_.count + KdCode::KD_CHUNK - 1) / KdCode::KD_CHUNK, 1u << root.cells.y, root.cells.y, 0};
    }

    // Sorts the photons of the round's large nodes by cell. Returns the next round's nodes, of which there may be none.
    Round split(const std::vector<Round>& rounds) {
        const size_t round = rounds.size() - 1;
        const Round& now = rounds.back();
        const BufferHandle& photons = photons_.photons;
        const BufferHandle args = arguments(rounds, round, 0);
        const BufferHandle larges = of("large nodes", round), chunks = of("chunks", round),
                           owners = of("owners", round);
        const BufferHandle order = kept("order"), places = kept("places"), scratch = kept("fluxes");
        const BufferHandle starts = keep_of("starts", round, (size_t(now.cells) + 1) * 4);
        const BufferHandle links = keep_of("links", round, size_t(now.cells) * 4);
        if (round > 0) {
            run(kBound, {args, photons, chunks, larges, order, places, scratch}, now.chunks * 32);
            run(kShape, {args, larges}, now.larges);
        }
        clear(starts, (size_t(now.cells) + 1) * 4);
        run(kCount, {args, photons, larges, chunks, places, starts, scratch}, now.chunks * 32);
        scan(starts, now.cells + 1);
        run(kScatter, {args, larges, chunks, starts, scratch, order}, now.chunks * 32);
        const glm::uvec4 none[2]{};
        const BufferHandle counters = upload("counters", none);
        run(kList, {args, larges, owners, starts, counters, links, larges, links, links}, now.cells);
        glm::uvec4 counted;
        counters->download(&counted, sizeof counted);
        const Round next{counted.x, counted.y, counted.z, counted.w, now.first_node + now.cells};
        if (next.larges == 0) return next;
        keep_of("large nodes", round + 1, size_t(next.larges) * sizeof(KdCode::KdLarge));
        keep_of("chunks", round + 1, size_t(next.chunks) * 4);
        keep_of("owners", round + 1, size_t(next.cells) / KdCode::KD_GROUP * 4);
        run(kList,
            {arguments(rounds, round, 1), larges, owners, starts, counters, links, of("large nodes", round + 1),
             of("chunks", round + 1), of("owners", round + 1)},
            now.cells);
        return next;
    }

    // Copies the photons that the round has brought to leaves, and builds its nodes.
    void join(const std::vector<Round>& rounds, size_t round) {
        const uint32_t groups = rounds[round].cells / KdCode::KD_GROUP;
        const BufferHandle boxes = keep("boxes", size_t(groups) * sizeof(KdCode::KdBox));
        const BufferHandle nodes = kept("nodes");
        const BufferHandle larges = of("large nodes", round), owners = of("owners", round),
                           starts = of("starts", round);
        const BufferHandle next = round + 1 < rounds.size() ? of("large nodes", round + 1) : larges;
        run(kLeaves,
            {arguments(rounds, round, 0), photons_.photons, larges, owners, starts, of("links", round), next,
             kept("order"), kept("places"), kept("fluxes"), nodes, boxes},
            groups);
        for (uint32_t step = 1; KdCode::KD_GROUP_LEVELS * step < rounds[round].levels; ++step)
            run(kLevels, {arguments(rounds, round, step), larges, owners, starts, nodes, boxes}, groups);
    }

    void construct(const PhotonSet& photons) override {
        const size_t count = photons.count;
        keep("order", count * 4);
        keep("places", count * 16);
        keep("fluxes", count * 16);
        std::vector<Round> rounds;
        if (count > 0)
            for (Round next = open_root(); next.larges > 0; next = split(rounds)) rounds.push_back(next);
        else
            rounds.emplace_back();
        rounds_ = 0;
        for (const Round& round : rounds)
            rounds_ += std::min(1.0, double(round.chunks) * KdCode::KD_CHUNK / std::max(1.0, double(count)));
        keep("nodes", (size_t(rounds.back().first_node) + rounds.back().cells) * sizeof(KdCode::KdNode));
        if (count > 0)
            for (size_t round = rounds.size(); round-- > 0;) join(rounds, round);
        arguments(rounds, 0, 0);
    }
    std::vector<BufferHandle> gather_buffers() const override {
        return {kept("arguments"), kept("nodes"), kept("places"), kept("fluxes")};
    }

 private:
    double rounds_ = 0;  // of the last build, of the mean photon
};

REGISTER_PHOTON_MAP(KdTree, KD_TREE_PARAMS, "kd_tree",
                    "A kd-tree over photons, built breadth first, many levels at once.")

}  // namespace
}  // namespace lampyris

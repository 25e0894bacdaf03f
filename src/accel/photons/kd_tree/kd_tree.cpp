#include "core/device/cpp_kernel.h"
#include "core/photons/photon_map.h"
#include "accel/photons/kd_tree/kd_tree_params.h"

#include <fmt/format.h>

#include <algorithm>

namespace lampyris {
namespace kernel {
namespace {

struct KdCode {
#include "accel/photons/kd_tree/kd_tree_layout.h"
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
    // The atomic counts; the accesses are to the place and the photon. All happen once for each round that the mean
    // photon of the last build went through.
    ConstructionTraffic traffic() const override { return {.accesses = 2 * rounds_, .atomics = rounds_}; }

 protected:
    static constexpr const char* kList = "accel/photons/kd_tree/kd_tree_list.kernel.h";
    static constexpr const char* kBound = "accel/photons/kd_tree/kd_tree_bound.kernel.h";
    static constexpr const char* kShape = "accel/photons/kd_tree/kd_tree_shape.kernel.h";
    static constexpr const char* kCount = "accel/photons/kd_tree/kd_tree_count.kernel.h";
    static constexpr const char* kScatter = "accel/photons/kd_tree/kd_tree_scatter.kernel.h";
    static constexpr const char* kLeaves = "accel/photons/kd_tree/kd_tree_leaves.kernel.h";
    static constexpr const char* kLevels = "accel/photons/kd_tree/kd_tree_levels.kernel.h";
    std::vector<std::string> kernels() const override {
        return {kList, kBound, kShape, kCount, kScatter, kLeaves, kLevels};
    }

    struct Round {
        uint32_t larges = 0, chunks = 0, cells = 0, levels = 0;  // `levels`: most levels of a node
        uint32_t first_node = 0;
    };

    // A buffer that each round has one of.
    const BufferHandle& keep_of(const char* what, size_t round, size_t bytes) {
        return keep(fmt::format("{} {}", what, round), bytes);
    }
    const BufferHandle& of(const char* what, size_t round) const { return kept(fmt::format("{} {}", what, round)); }
    BufferHandle arguments(const std::vector<Round>& rounds, size_t round, uint32_t step) {
        KdCode::KdArgs args{};
        args.count = photons_.count;
        args.leaf_photons = params.leaf;
        args.round = uint32_t(round);
        args.groups = rounds[round].cells / KdCode::KD_GROUP;
        args.first_node = rounds[round].first_node;
        args.next_node = rounds[round].first_node + rounds[round].cells;
        args.step = step;
        return upload("arguments", args);
    }

    // The node of all photons. Its bounds are the set's box, which may be wrong; later rounds compute the bounds of
    // their nodes.
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

    // Sorts the photons of the round's large nodes by cell. Returns the next round, which may have no nodes.
    Round split(const std::vector<Round>& rounds) {
        const size_t round = rounds.size() - 1;
        const Round& now = rounds.back();
        arguments(rounds, round, 0);
        const BufferHandle larges = of("large nodes", round), chunks = of("chunks", round),
                           owners = of("owners", round);
        const BufferHandle scratch = kept("fluxes");
        const BufferHandle starts = keep_of("starts", round, (size_t(now.cells) + 1) * 4);
        const BufferHandle links = keep_of("links", round, size_t(now.cells) * 4);
        if (round > 0) {
            run(kBound, now.chunks * 32, {{"chunks", chunks}, {"larges", larges}, {"scratch", scratch}});
            run(kShape, now.larges, {{"larges", larges}});
        }
        clear(starts, (size_t(now.cells) + 1) * 4);
        run(kCount, now.chunks * 32,
            {{"larges", larges}, {"chunks", chunks}, {"starts", starts}, {"scratch", scratch}});
        scan(starts, now.cells + 1);
        run(kScatter, now.chunks * 32,
            {{"larges", larges}, {"chunks", chunks}, {"starts", starts}, {"scratch", scratch}});
        const glm::uvec4 none[2]{};
        const BufferHandle counters = upload("counters", none);
        run(kList, now.cells,
            {{"larges", larges},
             {"owners", owners},
             {"starts", starts},
             {"links", links},
             {"next", larges},
             {"next_chunks", links},
             {"next_owners", links}});
        glm::uvec4 counted;
        counters->download(&counted, sizeof counted);
        const Round next{counted.x, counted.y, counted.z, counted.w, now.first_node + now.cells};
        if (next.larges == 0) return next;
        keep_of("large nodes", round + 1, size_t(next.larges) * sizeof(KdCode::KdLarge));
        keep_of("chunks", round + 1, size_t(next.chunks) * 4);
        keep_of("owners", round + 1, size_t(next.cells) / KdCode::KD_GROUP * 4);
        arguments(rounds, round, 1);
        run(kList, now.cells,
            {{"larges", larges},
             {"owners", owners},
             {"starts", starts},
             {"links", links},
             {"next", of("large nodes", round + 1)},
             {"next_chunks", of("chunks", round + 1)},
             {"next_owners", of("owners", round + 1)}});
        return next;
    }

    // Copies the photons that reached leaves in this round, and builds its nodes.
    void join(const std::vector<Round>& rounds, size_t round) {
        const uint32_t groups = rounds[round].cells / KdCode::KD_GROUP;
        keep("boxes", size_t(groups) * sizeof(KdCode::KdBox));
        const BufferHandle larges = of("large nodes", round), owners = of("owners", round),
                           starts = of("starts", round);
        const BufferHandle next = round + 1 < rounds.size() ? of("large nodes", round + 1) : larges;
        arguments(rounds, round, 0);
        run(kLeaves, groups,
            {{"larges", larges},
             {"owners", owners},
             {"starts", starts},
             {"links", of("links", round)},
             {"next", next}});
        for (uint32_t step = 1; KdCode::KD_GROUP_LEVELS * step < rounds[round].levels; ++step) {
            arguments(rounds, round, step);
            run(kLevels, groups, {{"larges", larges}, {"owners", owners}, {"starts", starts}});
        }
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

 private:
    double rounds_ = 0;  // that the mean photon of the last build went through
};

REGISTER_PHOTON_MAP(KdTree, KD_TREE_PARAMS, "kd_tree",
                    "A kd-tree over photons, built breadth first, many levels at once.")

}  // namespace
}  // namespace lampyris

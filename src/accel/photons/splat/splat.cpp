#include "core/device/cpp_kernel.h"
#include "core/photons/photon_grid.h"
#include "accel/photons/splat/splat_params.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

namespace lampyris {
namespace kernel {
namespace {

struct SplatCode {
#include "accel/photons/splat/splat_layout.h"
};

}  // namespace
}  // namespace kernel

namespace {

using SplatRecord = kernel::SplatCode::SplatRecord;

class Splat : public PhotonMap {
 public:
    SplatParams params;
    PhotonMapCapabilities capabilities() const override {
        return {.exact = true, .fixed_order = true, .needs_queries = true, .sums_only = true, .int64_atomics = true};
    }
    // The atomic counts; the accesses are to the start, the hit point and its index.
    ConstructionTraffic traffic() const override { return {.accesses = 3, .atomics = 1}; }

 protected:
    static constexpr const char* kCount = "accel/photons/splat/splat_count.kernel.h";
    static constexpr const char* kScatter = "accel/photons/splat/splat_scatter.kernel.h";
    std::vector<std::string> kernels() const override { return {kCount, kScatter}; }
    std::vector<std::string> gather_files() const override { return {"splat.gather.h", "splat_finish.gather.h"}; }

    void construct(const PhotonSet& photons) override {
        if (!photons.queries) throw std::logic_error("photon map splat is built from queries, and got none");
        SplatRecord record{};
        record.grid = make_grid(photons, params.cell_size);
        PhotonSet hits;
        hits.count = photons.query_count;
        const uint32_t entries = std::bit_ceil(table_entries(hits, params.table_size));
        record.grid.count = photons.query_count;
        record.grid.entries = entries;
        // Powers of two, so that scaling does not round. One unit is about 2^-30 of the mean power, and a sum of 2^33
        // times the mean power still fits.
        const float mean = photons.mean_power > 0 ? photons.mean_power : 1.0f;
        const float scale = std::ldexp(1.0f, std::clamp(30 - std::ilogb(mean), -100, 100));
        record.scale = glm::vec4(scale, scale, scale, std::ldexp(1.0f, 20));
        record.reach.x = std::max(photons.radius * 1.000001f, 4e-19f);  // range_reach of core/kernel/photon.h
        upload("splat", record);
        const BufferHandle starts = keep("starts", (size_t(entries) + 1) * 4);
        keep("ranks", size_t(photons.query_count) * 8);
        keep("sorted", size_t(photons.query_count) * 16);
        keep("ids", size_t(photons.query_count) * 4);
        keep("sums", size_t(photons.query_count) * 32);
        clear(starts, (size_t(entries) + 1) * 4);
        run(kCount, batch_count(photons.query_count), {{"hits", photons.queries}});
        scan(starts, entries + 1);
        run(kScatter, batch_count(photons.query_count), {{"hits", photons.queries}});
    }
    void run_gather(std::span<const Kernel* const> kernels, const PhotonConsumer& consumer, const BufferHandle& queries,
                    uint32_t first, uint32_t count) override {
        clear(kept("sums"), size_t(photons_.query_count) * 32);
        run_gather_kernel(*kernels[0], consumer, queries, 0, photons_.count);
        run_gather_kernel(*kernels[1], consumer, queries, first, count);
    }
};

REGISTER_PHOTON_MAP(Splat, SPLAT_PARAMS, "splat",
                    "Photons splat onto the hit points: a grid of hit points, and sums in fixed point.")

}  // namespace
}  // namespace lampyris

#include "core/device/cpp_kernel.h"
#include "core/photons/photon_grid.h"
#include "accel/photons/stochastic_hash/stochastic_hash_params.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace lampyris {
namespace kernel {
namespace {

struct HashCode {
#include "accel/photons/stochastic_hash/stochastic_hash_layout.h"
};

}  // namespace
}  // namespace kernel

namespace {

using HashRecord = kernel::HashCode::StochasticHash;

enum Selection : uint32_t { kRace, kPriority, kFlux };

class StochasticHash : public PhotonMap {
 public:
    StochasticHashParams params;
    PhotonMapCapabilities capabilities() const override {
        return {
            .stochastic = true, .fixed_order = params.selection != kRace, .int64_atomics = params.selection != kRace};
    }
    // Count and winner are in the same cache line.
    ConstructionTraffic traffic() const override { return {.accesses = 1, .atomics = 1}; }
    std::optional<BucketLoad> bucket_load() const override {
        if (params.selection == kFlux || buckets_ == 0) return std::nullopt;  // its counters hold sums of weights
        std::vector<uint64_t> table(size_t(buckets_) * (params.slots + 1));
        kept("table")->download(table.data(), table.size() * 8);
        BucketLoad load;
        uint64_t used = 0, sum = 0;
        for (size_t i = 0; i < table.size(); i += params.slots + 1) {
            used += table[i] != 0;
            sum += table[i];
            load.max = std::max(load.max, uint32_t(table[i]));
        }
        load.mean = used ? double(sum) / double(used) : 0.0;
        return load;
    }

 protected:
    std::string kernel_file() const {
        static constexpr const char* kNames[] = {"race", "priority", "flux"};
        return fmt::format("accel/photons/stochastic_hash/stochastic_hash_{}.kernel.h", kNames[params.selection]);
    }
    std::vector<std::string> kernels() const override { return {kernel_file()}; }
    void check() const override {
        if (params.slots > 1 && params.selection != kPriority)
            throw InputError("error: photon-map \"stochastic_hash\": more than one slot needs selection=priority");
    }

    void construct(const PhotonSet& photons) override {
        HashRecord record{};
        record.grid = make_grid(photons, params.cell_size);
        record.selection = params.selection;
        buckets_ = table_entries(photons, params.table_size);
        record.grid.entries = buckets_;
        record.grid.capacity = params.slots;
        record.grid.option = record.grid.resolution.w * 0x9e3779b9u + 1u;
        record.race_bits = std::max(11u, uint32_t(std::bit_width(std::max(photons.count, 1u) - 1)));
        // 1024 for a photon of mean power: weights are integers, and those above 4096 times the mean are clamped
        // (flux_weight).
        if (photons.mean_power > 0) record.flux_scale = 1024.0f / (3.0f * photons.mean_power);
        const size_t bytes = size_t(buckets_) * (params.slots + 1) * 8;
        const BufferHandle table = keep("table", bytes);
        upload("hash", record);
        clear(table, bytes);
        // A race visits all numbers of `race_bits` bits, including those that are not the index of a photon.
        const uint64_t items = params.selection == kRace ? uint64_t(1) << record.race_bits : photons.count;
        run(kernel_file(), span_count(uint32_t(items)));
    }

 private:
    uint32_t buckets_ = 0;
};

REGISTER_PHOTON_MAP(StochasticHash, STOCHASTIC_HASH_PARAMS, "stochastic_hash",
                    "A hash table that keeps one photon per bucket, which represents all that fell into it.")

}  // namespace
}  // namespace lampyris

#include "core/device/cpp_kernel.h"
#include "core/photons/photon_grid.h"
#include "accel/photons/cuckoo/cuckoo_params.h"

#include <algorithm>
#include <cmath>

namespace lampyris {
namespace kernel {
namespace {

struct CuckooCode {
#include "accel/photons/cuckoo/cuckoo_layout.h"
};

}  // namespace
}  // namespace kernel

namespace {

using CuckooRecord = kernel::CuckooCode::CuckooRecord;

class Cuckoo : public PhotonMap {
 public:
    CuckooParams params;
    PhotonMapCapabilities capabilities() const override { return {.exact = true, .fixed_order = true}; }
    // The access reads a photon; the atomics insert the cells of the last build into the table.
    ConstructionTraffic traffic() const override {
        return {.accesses = 1, .atomics = cells_per_photon_, .sorted_bits = 32};
    }

 protected:
    static constexpr const char* kCode = "accel/photons/cuckoo/cuckoo_code.kernel.h";
    static constexpr const char* kOrder = "accel/photons/cuckoo/cuckoo_order.kernel.h";
    static constexpr const char* kList = "accel/photons/cuckoo/cuckoo_list.kernel.h";
    static constexpr const char* kInsert = "accel/photons/cuckoo/cuckoo_insert.kernel.h";
    std::vector<std::string> kernels() const override {
        return {kCode, kOrder, kList, kInsert, kRadixKernels[0], kRadixKernels[1]};
    }

    void construct(const PhotonSet& photons) override {
        const uint32_t count = photons.count;
        CuckooRecord record{};
        record.grid = make_grid(photons, params.cell_size);
        record.stash = params.stash;
        const BufferHandle pairs = keep("pairs", size_t(count) * 8), other = keep("pairs 2", size_t(count) * 8);
        keep("places", size_t(count) * 16);
        keep("fluxes", size_t(count) * 16);
        keep("cells", (size_t(count) + 1) * 8);
        const BufferHandle runs = keep("runs", (size_t(count) + 1) * 4);
        upload("cuckoo", record);
        run(kCode, count);
        const BufferHandle sorted = radix_sort(pairs, other, count, 32);
        const BufferHandle order = sorted == pairs ? other : pairs;
        const uint32_t none = 0;
        runs->upload(&none, 4, size_t(count) * 4);
        run(kOrder, batch_count(count), {{"pairs", sorted}, {"order", order}});
        scan(runs, count + 1);
        run(kList, batch_count(count + 1), {{"pairs", sorted}});
        runs->download(&record.cells, 4, size_t(count) * 4);
        cells_per_photon_ = double(record.cells) / std::max(1.0, double(count));
        fill_table(record);
    }

    // Retries with new hash functions until every cell has an entry or fits the stash. The table grows with each
    // attempt, so that this terminates.
    void fill_table(CuckooRecord& record) {
        double entries = std::ceil(record.cells * double(params.table_size)) + 4;
        for (uint32_t attempt = 0;; ++attempt, entries *= 1.1) {
            record.grid.entries = uint32_t(entries);
            for (int way = 0; way < 4; ++way)
                record.seeds[way] = record.grid.resolution.w + 0x9e3779b9u * (4 * attempt + uint32_t(way) + 1);
            upload("cuckoo", record);
            const BufferHandle table = keep("table", size_t(record.grid.entries) * 4);
            const BufferHandle stash = keep("stash", (size_t(params.stash) + 1) * 4);
            clear(table, size_t(record.grid.entries) * 4);
            const uint32_t none = 0;
            stash->upload(&none, 4);
            run(kInsert, record.cells);
            uint32_t stashed = 0;
            stash->download(&stashed, 4);
            if (stashed <= params.stash) return;
        }
    }

 private:
    double cells_per_photon_ = 0;
};

REGISTER_PHOTON_MAP(Cuckoo, CUCKOO_PARAMS, "cuckoo",
                    "Photons sorted by cell, and a cuckoo hash table from cells to their photons.")

}  // namespace
}  // namespace lampyris

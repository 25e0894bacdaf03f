#include "core/photons/photon_grid.h"
#include "accel/photons/sorted_grid/sorted_grid_params.h"

#include <bit>

namespace lampyris {
namespace {

class SortedGrid : public PhotonMap {
 public:
    SortedGridParams params;
    PhotonMapCapabilities capabilities() const override { return {.exact = true, .fixed_order = true}; }
    // The atomic counts; the accesses are to the start, the pair and the photon.
    ConstructionTraffic traffic() const override { return {.accesses = 3, .atomics = 1}; }

 protected:
    static constexpr const char* kCount = "accel/photons/sorted_grid/sorted_grid_count.kernel.h";
    static constexpr const char* kScatter = "accel/photons/sorted_grid/sorted_grid_scatter.kernel.h";
    static constexpr const char* kOrder = "accel/photons/sorted_grid/sorted_grid_order.kernel.h";
    std::vector<std::string> kernels() const override { return {kCount, kScatter, kOrder}; }

    void construct(const PhotonSet& photons) override {
        kernel::PhotonGrid grid = make_grid(photons, params.cell_size);
        const uint32_t entries = std::bit_ceil(table_entries(photons, params.table_size));
        grid.entries = entries;
        upload("grid", grid);
        const BufferHandle starts = keep("starts", (size_t(entries) + 1) * 4);
        const BufferHandle ranks = keep("ranks", size_t(photons.count) * 8);
        const BufferHandle order = keep("order", size_t(photons.count) * 8);
        keep("places", size_t(photons.count) * 16);
        keep("fluxes", size_t(photons.count) * 16);
        const uint32_t batches = batch_count(photons.count);
        clear(starts, (size_t(entries) + 1) * 4);
        run(kCount, span_count(photons.count));
        scan(starts, entries + 1);
        run(kScatter, batches);
        run(kOrder, batch_count(entries), {{"pairs", order}, {"order", ranks}});
    }
};

REGISTER_PHOTON_MAP(SortedGrid, SORTED_GRID_PARAMS, "sorted_grid",
                    "A hash grid whose photons are sorted by cell: count, scan, scatter.")

}  // namespace
}  // namespace lampyris

#include "core/photon_grid.h"
#include "accel/linked_list/linked_list.params.h"

namespace lampyris {
namespace {

class LinkedList : public PhotonMap {
 public:
    LinkedListParams params;
    PhotonMapCapabilities capabilities() const override { return {.exact = true, .fixed_order = params.order == 0}; }
    // Link; for the order, the key and link of each.
    ConstructionTraffic traffic() const override { return {.accesses = params.order == 0 ? 1.0 : 0.0, .atomics = 1}; }

 protected:
    static constexpr const char* kLink = "accel/linked_list/linked_list_link.kernel.h";
    static constexpr const char* kOrder = "accel/linked_list/linked_list_order.kernel.h";
    static constexpr const char* kPlace = "accel/linked_list/linked_list_place.kernel.h";
    static constexpr uint32_t kSpan = 16;  // CHAIN_SPAN of linked_list_chains.layout.h
    std::vector<std::string> kernels() const override { return {kLink, kOrder, kPlace}; }

    void construct(const PhotonSet& photons) override {
        const bool keyed = params.order == 0;
        const size_t count = photons.count;
        kernel::PhotonGrid grid = make_grid(photons, params.cell_size);
        grid.entries = table_entries(photons, params.table_size);
        grid.option = keyed;
        upload("grid", grid);
        const BufferHandle heads = keep("heads", size_t(grid.entries) * 4);
        keep("links", keyed ? count * 8 : 8);
        keep("nodes", count * 16);
        clear(heads, size_t(grid.entries) * 4);
        run(kLink, span_count(photons.count));
        if (!keyed) return;
        run(kOrder, (batch_count(grid.entries) + kSpan - 1) / kSpan);
        run(kPlace, batch_count(photons.count));
    }
};

REGISTER_PHOTON_MAP(LinkedList, LINKED_LIST_PARAMS, "linked_list",
                    "A hash grid with chains, linked in parallel by atomic exchange.")

}  // namespace
}  // namespace lampyris

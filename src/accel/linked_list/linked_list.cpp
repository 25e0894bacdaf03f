#include "core/photon_grid.h"
#include "accel/linked_list/linked_list.params.h"

namespace lampyris {
namespace {

class LinkedList : public PhotonMap {
 public:
    LinkedListParams params;
    PhotonMapCapabilities capabilities() const override { return {.exact = true, .fixed_order = params.order == 0}; }
    // Link; for the order, the node and its key.
    ConstructionTraffic traffic() const override { return {.accesses = params.order == 0 ? 2.0 : 0.0, .atomics = 1}; }

 protected:
    static constexpr const char* kLink = "accel/linked_list/linked_list_link.kernel.h";
    static constexpr const char* kOrder = "accel/linked_list/linked_list_order.kernel.h";
    std::vector<std::string> kernels() const override { return {kLink, kOrder}; }

    void construct(const PhotonSet& photons) override {
        kernel::PhotonGrid grid = make_grid(photons, params.cell_size);
        grid.sizes.y = table_entries(photons, params.table_size);
        const BufferHandle record = upload("grid", grid);
        const BufferHandle heads = keep("heads", size_t(grid.sizes.y) * 4);
        const BufferHandle nodes = keep("nodes", size_t(photons.count) * 16);
        clear(heads, size_t(grid.sizes.y) * 4);
        run(kLink, {record, photons.photons, heads, nodes}, batch_count(photons.count));
        if (params.order == 0) run(kOrder, {record, photons.photons, heads, nodes}, batch_count(grid.sizes.y));
    }
    std::vector<BufferHandle> gather_buffers() const override {
        return {kept("grid"), kept("heads"), kept("nodes"), photons_.photons};
    }
};

REGISTER_PHOTON_MAP(LinkedList, LINKED_LIST_PARAMS, "linked_list",
                    "A hash grid with chains, linked in parallel by atomic exchange.")

}  // namespace
}  // namespace lampyris

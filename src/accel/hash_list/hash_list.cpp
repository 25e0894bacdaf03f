#include "core/photon_grid.h"
#include "accel/linked_list/linked_list.params.h"

namespace lampyris {
namespace {

class HashList : public PhotonMap {
 public:
    LinkedListParams params;
    PhotonMapCapabilities capabilities() const override { return {.exact = true, .fixed_order = params.order == 0}; }
    // Link; for the order, the node and its key.
    ConstructionTraffic traffic() const override {
        return {.accesses = params.order == 0 ? 2.0 : 0.0, .atomics = 1, .one_thread = true};
    }

 protected:
    static constexpr const char* kInsert = "accel/hash_list/hash_list_insert.kernel.h";
    static constexpr const char* kOrder = "accel/hash_list/hash_list_order.kernel.h";
    static constexpr uint32_t kChunk = 4096, kOrderChunk = 1024;  // CHUNK of both
    std::vector<std::string> kernels() const override { return {kInsert, kOrder}; }

    void construct(const PhotonSet& photons) override {
        kernel::PhotonGrid grid = make_grid(photons, params.cell_size);
        grid.sizes.y = table_entries(photons, params.table_size);
        const BufferHandle record = upload("grid", grid);
        const BufferHandle heads = keep("heads", size_t(grid.sizes.y) * 4);
        const BufferHandle nodes = keep("nodes", size_t(photons.count) * 16);
        clear(heads, size_t(grid.sizes.y) * 4);
        run_serially(kInsert, {record, photons.photons, heads, nodes}, (photons.count + kChunk - 1) / kChunk);
        if (params.order == 0)
            run_serially(kOrder, {record, photons.photons, heads, nodes},
                         (grid.sizes.y + kOrderChunk - 1) / kOrderChunk);
    }
    std::vector<BufferHandle> gather_buffers() const override {
        return {kept("grid"), kept("heads"), kept("nodes"), photons_.photons};
    }
};

REGISTER_PHOTON_MAP(HashList, LINKED_LIST_PARAMS, "hash_list",
                    "A hash grid with lists, built by one thread: the baseline of the paper on a CPU.")

}  // namespace
}  // namespace lampyris

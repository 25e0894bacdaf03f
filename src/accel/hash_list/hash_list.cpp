#include "core/photon_grid.h"
#include "accel/linked_list/linked_list.params.h"

namespace lampyris {
namespace {

class HashList : public PhotonMap {
 public:
    LinkedListParams params;
    PhotonMapCapabilities capabilities() const override { return {.exact = true, .fixed_order = params.order == 0}; }
    // The head, without an atomic; for the order, the key and link of each.
    ConstructionTraffic traffic() const override {
        return {.accesses = params.order == 0 ? 2.0 : 1.0, .one_thread = true};
    }

 protected:
    static constexpr const char* kInsert = "accel/hash_list/hash_list_insert.kernel.h";
    static constexpr const char* kOrder = "accel/hash_list/hash_list_order.kernel.h";
    static constexpr const char* kPlace = "accel/hash_list/hash_list_place.kernel.h";
    static constexpr uint32_t kChunk = 4096;   // CHUNK of the first and the last
    static constexpr uint32_t kSpan = 16 * 8;  // CHAIN_SPAN of linked_list_chains.layout.h, CHUNK of hash_list_order
    std::vector<std::string> kernels() const override { return {kInsert, kOrder, kPlace}; }

    void construct(const PhotonSet& photons) override {
        const bool keyed = params.order == 0;
        const size_t count = photons.count;
        const uint32_t chunks = (photons.count + kChunk - 1) / kChunk;
        kernel::PhotonGrid grid = make_grid(photons, params.cell_size);
        grid.entries = table_entries(photons, params.table_size);
        grid.option = keyed;
        upload("grid", grid);
        const BufferHandle heads = keep("heads", size_t(grid.entries) * 4);
        keep("links", keyed ? count * 8 : 8);
        keep("nodes", count * 16);
        clear(heads, size_t(grid.entries) * 4);
        run_serially(kInsert, chunks);
        if (!keyed) return;
        run_serially(kOrder, (batch_count(grid.entries) + kSpan - 1) / kSpan);
        run_serially(kPlace, chunks);
    }
};

REGISTER_PHOTON_MAP(HashList, LINKED_LIST_PARAMS, "hash_list",
                    "A hash grid with lists, built by one thread: the baseline of the paper on a CPU.")

}  // namespace
}  // namespace lampyris

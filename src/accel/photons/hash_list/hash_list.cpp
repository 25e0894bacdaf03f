#include "accel/photons/linked_list/list_grid.h"

namespace lampyris {
namespace {

class HashList : public ListGrid {
 public:
    // An access to the head of a bucket, without an atomic; if chains are sorted, another to the photon's key and link.
    ConstructionTraffic traffic() const override { return {.accesses = keyed() ? 2.0 : 1.0, .one_thread = true}; }

 protected:
    static constexpr const char* kInsert = "accel/photons/hash_list/hash_list_insert.kernel.h";
    static constexpr const char* kOrder = "accel/photons/hash_list/hash_list_order.kernel.h";
    static constexpr const char* kPlace = "accel/photons/hash_list/hash_list_place.kernel.h";
    static constexpr uint32_t kChunk = 4096;   // CHUNK of hash_list_insert and hash_list_place
    static constexpr uint32_t kSpan = 16 * 8;  // CHAIN_SPAN of linked_list_chains.h * CHUNK of hash_list_order
    std::vector<std::string> kernels() const override { return {kInsert, kOrder, kPlace}; }

    void construct(const PhotonSet& photons) override {
        const uint32_t chunks = (photons.count + kChunk - 1) / kChunk;
        const uint32_t chains = open_chains(photons);
        run_serially(kInsert, chunks);
        if (!keyed()) return;
        run_serially(kOrder, (batch_count(chains) + kSpan - 1) / kSpan);
        run_serially(kPlace, chunks);
    }
};

REGISTER_PHOTON_MAP(HashList, LINKED_LIST_PARAMS, "hash_list",
                    "A hash grid with lists, built by one thread: the baseline of the paper on a CPU.")

}  // namespace
}  // namespace lampyris

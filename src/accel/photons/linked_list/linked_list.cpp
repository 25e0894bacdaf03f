#include "accel/photons/linked_list/list_grid.h"

namespace lampyris {
namespace {

class LinkedList : public ListGrid {
 public:
    // The atomic links a photon; if chains are sorted, an access to its key and link.
    ConstructionTraffic traffic() const override { return {.accesses = keyed() ? 1.0 : 0.0, .atomics = 1}; }

 protected:
    static constexpr const char* kLink = "accel/photons/linked_list/linked_list_link.kernel.h";
    static constexpr const char* kOrder = "accel/photons/linked_list/linked_list_order.kernel.h";
    static constexpr const char* kPlace = "accel/photons/linked_list/linked_list_place.kernel.h";
    static constexpr uint32_t kSpan = 16;  // CHAIN_SPAN of linked_list_chains.h
    std::vector<std::string> kernels() const override { return {kLink, kOrder, kPlace}; }

    void construct(const PhotonSet& photons) override {
        const uint32_t chains = open_chains(photons);
        run(kLink, span_count(photons.count));
        if (!keyed()) return;
        run(kOrder, (batch_count(chains) + kSpan - 1) / kSpan);
        run(kPlace, batch_count(photons.count));
    }
};

REGISTER_PHOTON_MAP(LinkedList, LINKED_LIST_PARAMS, "linked_list",
                    "A hash grid with chains, linked in parallel by atomic exchange.")

}  // namespace
}  // namespace lampyris

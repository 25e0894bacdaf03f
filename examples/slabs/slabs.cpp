#include "core/photons/photon_map.h"
#include "slabs/slabs_layout.h"
#include "slabs/slabs_params.h"

#include <algorithm>
#include <bit>

namespace {

using namespace lampyris;

class SlabMap : public PhotonMap {
 public:
    SlabsParams params;
    PhotonMapCapabilities capabilities() const override { return {.exact = true}; }

 protected:
    static constexpr const char* kKeys = "slabs/slabs_keys.kernel.h";
    static constexpr const char* kOrder = "slabs/slabs_order.kernel.h";
    static constexpr const char* kStarts = "slabs/slabs_starts.kernel.h";
    std::vector<std::string> kernels() const override {
        return {kKeys, kOrder, kStarts, kRadixKernels[0], kRadixKernels[1]};
    }

    void construct(const PhotonSet& set) override {
        Slabs record{};
        record.slabs = params.slabs;
        record.photons = set.count;
        record.low = set.low.z;
        record.scale = float(params.slabs) / std::max(set.high.z - set.low.z, 1e-30f);
        upload("slabs", record);
        const BufferHandle pairs = keep("pairs", size_t(set.count) * 8);
        const BufferHandle other = keep("other pairs", size_t(set.count) * 8);
        keep("ordered", size_t(set.count) * sizeof(kernel::PhotonRecord));
        keep("starts", (size_t(params.slabs) + 1) * 4);
        run(kKeys, set.count);
        const BufferHandle sorted = radix_sort(pairs, other, set.count, uint32_t(std::bit_width(params.slabs)));
        run(kOrder, set.count, {{"sorted", sorted}});
        run(kStarts, params.slabs + 1, {{"sorted", sorted}});
    }
};

REGISTER_PHOTON_MAP(SlabMap, SLABS_PARAMS_LIST, "slabs", "Photons sorted into slabs along the z axis.")

}  // namespace

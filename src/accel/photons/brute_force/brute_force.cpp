#include "core/photons/photon_map.h"

namespace lampyris {
namespace {

struct BruteForceParams {};
#define BRUTE_FORCE_PARAMS(P)

class BruteForce : public PhotonMap {
 public:
    BruteForceParams params;
    PhotonMapCapabilities capabilities() const override { return {.exact = true, .fixed_order = false}; }

 protected:
    std::vector<std::string> kernels() const override { return {}; }
    void construct(const PhotonSet& photons) override { upload("arguments", glm::uvec4(photons.count, 0, 0, 0)); }
};

REGISTER_PHOTON_MAP(BruteForce, BRUTE_FORCE_PARAMS, "brute_force",
                    "Every photon is tested: slow, and right by definition.")

}  // namespace
}  // namespace lampyris

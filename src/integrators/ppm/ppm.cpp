#include "integrators/sppm/photon_mapping.h"

#include <algorithm>

namespace lampyris {
namespace {

class Ppm : public Integrator {
 public:
    SppmParams params;
    bool uses_photon_map() const override { return true; }
    bool fixes_eye_samples() const override { return true; }
    void render(RenderSession& session) override {
        render_photon_mapping(session, params, std::max(session.eye_samples, 1u));
    }
};

REGISTER_INTEGRATOR(Ppm, SPPM_PARAMS, "ppm",
                    "Progressive photon mapping: hit points that stay where the first pass put them.")

}  // namespace
}  // namespace lampyris

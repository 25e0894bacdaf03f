#include "integrators/sppm/photon_mapping.h"

namespace lampyris {
namespace {

class Sppm : public Integrator {
 public:
    SppmParams params;
    bool uses_photon_map() const override { return true; }
    ErrorRate error_rate() const override { return ErrorRate::of_photons(double(params.alpha)); }
    void render(RenderSession& session) override { render_photon_mapping(session, params, 0); }
};

REGISTER_INTEGRATOR(Sppm, SPPM_PARAMS, "sppm",
                    "Stochastic progressive photon mapping: new hit points in every pass share a pixel's statistics.")

}  // namespace
}  // namespace lampyris

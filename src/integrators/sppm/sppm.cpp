#include "integrators/photon_paths/progressive.h"

namespace lampyris {
namespace {

class Sppm : public Integrator {
 public:
    ProgressiveParams params;
    bool uses_photon_map() const override { return true; }
    ErrorRate error_rate() const override { return ErrorRate::of_photons(double(params.alpha)); }
    void render(RenderSession& session) override { render_progressive(session, params, 0); }
};

REGISTER_INTEGRATOR(Sppm, PROGRESSIVE_PARAMS, "sppm",
                    "Stochastic progressive photon mapping: new hit points in every pass share a pixel's statistics.")

}  // namespace
}  // namespace lampyris

#include "core/render/integrator.h"
#include "integrators/bidirectional/bidirectional.h"
#include "integrators/bpm/bpm_params.h"

namespace lampyris {
namespace {

class Bpm : public Integrator {
 public:
    BpmParams params;
    bool uses_photon_map() const override { return true; }
    ErrorRate error_rate() const override { return ErrorRate::of_photons(double(params.alpha)); }

    void render(RenderSession& session) override {
        render_bidirectional(session, {.name = "bpm",
                                       .maxdepth = params.maxdepth,
                                       .rrdepth = params.rrdepth,
                                       .lightpaths = params.lightpaths,
                                       .weights = params.weights,
                                       .strategies = kernel::STRATEGIES_MERGING,
                                       .radius = double(params.radius),
                                       .radius_share = double(params.share),
                                       .alpha = double(params.alpha)});
    }
};

REGISTER_INTEGRATOR(Bpm, BPM_PARAMS, "bpm",
                    "Bidirectional photon mapping: photons are merged with every vertex of camera paths.")

}  // namespace
}  // namespace lampyris

#include "core/render/integrator.h"
#include "integrators/bidirectional/bidirectional.h"
#include "integrators/vcm/vcm_params.h"

namespace lampyris {
namespace {

class Vcm : public Integrator {
 public:
    VcmParams params;
    bool uses_photon_map() const override { return true; }
    ErrorRate error_rate() const override { return ErrorRate::of_photons(double(params.alpha)); }

    void render(RenderSession& session) override {
        render_bidirectional(session, {.name = "vcm",
                                       .maxdepth = params.maxdepth,
                                       .rrdepth = params.rrdepth,
                                       .lightpaths = params.lightpaths,
                                       .connections = params.connections,
                                       .weights = params.weights,
                                       .radius = double(params.radius),
                                       .radius_share = double(params.share),
                                       .alpha = double(params.alpha)});
    }
};

REGISTER_INTEGRATOR(Vcm, VCM_PARAMS, "vcm",
                    "Vertex connection and merging: bidirectional path tracing united with photon mapping.")

}  // namespace
}  // namespace lampyris

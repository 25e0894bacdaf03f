#include "core/render/integrator.h"
#include "integrators/bidirectional/bidirectional.h"
#include "integrators/bidirectional/pilot.h"
#include "integrators/vcm/vcm_params.h"

namespace lampyris {
namespace {

class Vcm : public Integrator {
 public:
    VcmParams params;
    bool uses_photon_map() const override { return true; }
    ErrorRate error_rate() const override { return ErrorRate::of_photons(double(params.alpha)); }

    void render(RenderSession& session) override {
        BidirectionalOptions options = connection_options("vcm", params);
        options.radius = double(params.radius);
        options.radius_share = double(params.share);
        options.alpha = double(params.alpha);
        if (params.counts != 0) options = choose_counts(session, options);
        render_bidirectional(session, options);
    }
};

REGISTER_INTEGRATOR(Vcm, VCM_PARAMS, "vcm",
                    "Vertex connection and merging: bidirectional path tracing united with photon mapping.")

}  // namespace
}  // namespace lampyris

#include "core/render/integrator.h"
#include "integrators/bdpt/bdpt_params.h"
#include "integrators/bidirectional/bidirectional.h"

namespace lampyris {
namespace {

class Bdpt : public Integrator {
 public:
    BdptParams params;

    void render(RenderSession& session) override {
        render_bidirectional(session, {.name = "bdpt",
                                       .maxdepth = params.maxdepth,
                                       .rrdepth = params.rrdepth,
                                       .lightpaths = params.lightpaths,
                                       .connections = params.connections,
                                       .weights = params.weights,
                                       .only_light = params.s,
                                       .only_camera = params.t});
    }
};

REGISTER_INTEGRATOR(Bdpt, BDPT_PARAMS, "bdpt",
                    "Bidirectional path tracing: paths from the camera and from lights, connected in all ways.")

}  // namespace
}  // namespace lampyris

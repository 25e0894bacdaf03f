#include "core/render/integrator.h"
#include "facing/facing_params.h"

namespace {

class Facing : public lampyris::Integrator {
 public:
    FacingParams params;
    void render(lampyris::RenderSession& session) override {
        render_samples(session, "facing/facing.radiance.h", &params, sizeof(params));
    }
};

REGISTER_INTEGRATOR(Facing, FACING_PARAMS_LIST, "facing", "Facing ratio: how squarely each surface faces the viewer.")

}  // namespace

#include "core/render/integrator.h"
#include "integrators/ao/ao_params.h"

namespace lampyris {
namespace {

class Ao : public Integrator {
 public:
    AoParams params;
    void render(RenderSession& session) override {
        render_samples(session, "integrators/ao/ao.radiance.h", &params, sizeof(params));
    }
};

REGISTER_INTEGRATOR(Ao, AO_PARAMS, "ao", "Ambient occlusion: the share of the sky that each point sees.")

}  // namespace
}  // namespace lampyris

#include "core/render/integrator.h"
#include "integrators/path/path_params.h"

namespace lampyris {
namespace {

class Path : public Integrator {
 public:
    PathParams params;
    void render(RenderSession& session) override {
        render_samples(session, "integrators/path/path.radiance.h", &params, sizeof(params));
    }
};

REGISTER_INTEGRATOR(Path, PATH_PARAMS, "path",
                    "Path tracing with next-event estimation and multiple importance sampling.")

}  // namespace
}  // namespace lampyris

#include "core/base/error.h"
#include "core/render/integrator.h"
#include "integrators/bdpt/bdpt_params.h"
#include "integrators/bidirectional/bidirectional.h"
#include "integrators/bidirectional/pilot.h"

#include <fmt/format.h>

namespace lampyris {
namespace {

class Bdpt : public Integrator {
 public:
    BdptParams params;

    void render(RenderSession& session) override {
        constexpr int kDeepest = 16;  // 170 strategies
        if (params.strategies != 0 && params.maxdepth > kDeepest)
            throw InputError(fmt::format(
                "error: strategies=on keeps two images of each strategy: choose a maxdepth of at most {}", kDeepest));
        if (params.weights == kernel::WEIGHTS_NONE && (params.s < 0 || params.t < 0))
            throw InputError(
                "error: weights=none shows one strategy as if it were alone: choose it by s and t, its vertices from "
                "the light "
                "and from the camera");
        if (params.counts != 0 && (params.s >= 0 || params.t >= 0))
            throw InputError("error: counts=auto chooses among strategies, and s and t name one: give either");
        if (params.counts != 0 && params.strategies != 0)
            throw InputError("error: counts=auto leaves strategies out, and strategies=on shows all: give either");
        BidirectionalOptions options = connection_options("bdpt", params);
        options.only_light = params.s;
        options.only_camera = params.t;
        if (params.counts != 0) options = choose_counts(session, options);
        render_bidirectional(session, options);
        if (params.strategies != 0) render_strategies(session, options, params.maxdepth);
    }
};

REGISTER_INTEGRATOR(Bdpt, BDPT_PARAMS, "bdpt",
                    "Bidirectional path tracing: paths from the camera and from lights, connected in all ways.")

}  // namespace
}  // namespace lampyris

#include "integrators/bidirectional/bidirectional.h"

#include <fmt/format.h>

#include <array>
#include <string>

namespace lampyris {

void render_strategies(RenderSession& session, const BidirectionalOptions& options, int depth) {
    const uint64_t passes = session.progress().passes;
    const glm::uvec4 window = session.film.window();
    const std::array<int, 4> crop{int(window.x), int(window.y), int(window.x + window.z), int(window.y + window.w)};
    const auto add_layer = [&](const std::string& name, int s, int t, uint32_t weights) {
        Film film(session.device, session.scene, crop);
        BudgetLimits limits;
        limits.passes = passes;
        RenderSession own(session.device, session.scene, session.device_scene, film, limits);
        own.seed = session.seed;
        own.sampler = session.sampler;
        own.start_at(session.next_pass() - passes);
        BidirectionalOptions one = options;
        one.weights = weights;
        one.only_light = s;
        one.only_camera = t;
        render_bidirectional(own, one);
        film.download();
        session.layers.push_back({fmt::format("{}.s{}t{}", name, s, t), film.rgb()});
    };
    for (int k = 0; k <= depth && passes > 0; ++k)
        for (int s = 0; s <= (k > 0 ? k + 1 : 0); ++s) {
            add_layer("strategy", s, k + 2 - s, options.weights);
            add_layer("alone", s, k + 2 - s, kernel::WEIGHTS_NONE);
        }
}

}  // namespace lampyris

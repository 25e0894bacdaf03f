#include "integrators/photon_paths/progressive.h"

#include <fmt/format.h>

#include <algorithm>

namespace lampyris {
namespace {

class Ppm : public Integrator {
 public:
    ProgressiveParams params;
    bool uses_photon_map() const override { return true; }
    ErrorRate error_rate() const override { return ErrorRate::of_photons(double(params.alpha)); }
    bool fixes_eye_samples() const override { return true; }
    std::string unseen_error(uint32_t eye_samples) const override {
        constexpr uint32_t kEnough = 16;  // then the error within the pixel is usually small beside the rest
        if (eye_samples >= kEnough) return {};
        return fmt::format(
            "all passes share {} of a pixel: the estimate misses edges and reflections between them, and other choices "
            "of masks, mixes and lobes along their paths",
            eye_samples > 1 ? fmt::format("{} eye samples", eye_samples) : "one eye sample");
    }
    void render(RenderSession& session) override {
        render_progressive(session, params, std::max(session.eye_samples, 1u));
    }
};

REGISTER_INTEGRATOR(Ppm, PROGRESSIVE_PARAMS, "ppm",
                    "Progressive photon mapping: all passes share the hit points of the first pass.")

}  // namespace
}  // namespace lampyris

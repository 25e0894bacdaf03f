// What an integrator's render() works with: device, scene, film, and a budget of passes.
#pragma once

#include "core/device/device.h"
#include "core/render/film.h"
#include "core/render/forecast.h"
#include "core/render/path_log.h"
#include "core/scene/scene.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace lampyris {

// The first limit reached stops the rendering.
struct BudgetLimits {
    std::optional<uint64_t> passes;
    std::optional<double> seconds;
    std::optional<double> target_error;  // estimated relMSE
    bool accept_unstable = false;        // the target also counts as reached if the estimate cannot be trusted
};

// Why a rendering ended: by which limit, or because it was interrupted (core/base/watch.h).
enum class RenderEnd { kPasses, kTime, kTargetError, kInterrupted };

enum class TargetState { kNone, kAbove, kUnknown, kBelowButUnstable, kReached };

// The state of a rendering after some passes; what progress displays and statistics see.
struct RenderProgress {
    uint64_t passes = 0;
    double wall_s = 0.0;           // time spent rendering: without set-up, and without evaluating the film
    double estimated_error = 0.0;  // estimated relMSE; NaN if not known yet
    ErrorForecast forecast{};      // time until it has halved
    std::string unstable;          // why the estimate cannot be trusted; empty if nothing speaks against it
    uint64_t rays = 0, samples = 0;
    TargetState target = TargetState::kNone;  // the estimate compared with BudgetLimits::target_error
    bool finished = false;
};

// Results of photon mapping, for the statistics.
struct PhotonStatistics {
    uint64_t emitted = 0, stored = 0, lost = 0, rays = 0;
    double radius_initial = 0.0, radius_min = 0.0, radius_mean = 0.0,
           radius_max = 0.0;        // of the last pass, in scene units
    double bucket_load_mean = 0.0;  // 0: there are no buckets
    uint32_t bucket_load_max = 0;
    size_t map_bytes = 0;
    std::vector<std::pair<std::string, std::string>> map_parameters;
};

// A further image of the same pixels: [height][width][3], linear Rec. 709.
struct ImageLayer {
    std::string name;
    std::vector<float> rgb;
};

// The state of a rendering after some passes, without its film: what a checkpoint keeps.
struct SessionState {
    uint64_t passes = 0;
    double wall_s = 0.0;
    std::vector<ErrorPoint> history;
    std::map<std::string, double> phases, counts;
    PhotonStatistics photons;  // its counts
    struct Part {
        std::string name;
        std::vector<std::byte> bytes;
    };
    std::vector<Part> parts;  // RenderSession::keep
};

class RenderSession {
 public:
    RenderSession(Device& device, const Scene& scene, DeviceSceneHandle device_scene, Film& film, BudgetLimits limits);

    Device& device;
    const Scene& scene;
    const DeviceSceneHandle device_scene;
    Film& film;
    uint32_t seed = 0;
    uint32_t sampler = 0;      // kernel::SAMPLER_*
    uint32_t max_slice = 0;    // maximum of passes in a slice; 0: no limit
    uint32_t eye_samples = 1;  // per pixel, for integrators that fix them
    std::string photon_map;    // NAME[:key=value,...]; for integrators that use one
    PhotonStatistics photons;
    std::vector<ImageLayer> layers;                  // become channels NAME.R, NAME.G, NAME.B of the image
    ErrorRate error_rate = ErrorRate::of_samples();  // the integrator's convergence rate in theory
    PathLogger* path_log = nullptr;                  // of a replay: integrators call its functions where it applies
    std::string unseen_error;  // an error that the variance between passes cannot show; makes the estimate unstable

    // How many passes to run next, starting with number next_pass(): 0 when the budget is spent or the rendering is
    // interrupted. Slices last a fraction of a second (unless one pass takes longer), and end at powers of two.
    uint32_t next_passes();
    // To be called after each slice.
    void passes_finished(uint32_t count);
    // The number of the next pass. It counts from 0, or from `first` (for replaying one pass alone).
    uint64_t next_pass() const { return first_pass_ + progress_.passes; }
    void start_at(uint64_t first) { first_pass_ = first; }
    uint64_t first_pass() const { return first_pass_; }
    // The film's part of the image, and `samples` samples starting at `first`, for kernels.
    kernel::FilmWindow window(uint32_t first, uint32_t samples) const;
    const RenderProgress& progress() const { return progress_; }
    RenderEnd ended() const;
    // The film at the last look.
    const FilmSummary& looked() const { return looked_; }

    // To be called if a pass threw Cancelled: the film's contents count, the pass does not.
    void pass_was_cancelled() { interrupted_ = true; }

    // How often something happened ("connections_visible", ...), or another number about the rendering, for the statistics.
    void add_count(const std::string& name, double count) { counts_[name] += count; }
    void set_count(const std::string& name, double value) { counts_[name] = value; }
    const std::map<std::string, double>& counts() const { return counts_; }

    // What the integrator chose for this scene where its parameters leave it open ("light_paths", "0"), for the statistics; and a
    // line that says so.
    void add_choice(const std::string& name, const std::string& value) { choices_.emplace_back(name, value); }
    const std::vector<std::pair<std::string, std::string>>& choices() const { return choices_; }
    std::function<void(const std::string&)> on_note;

    // What passes leave to later ones, apart from the film, is named here before the first pass, when it has its initial content:
    // checkpoints have it. In a rendering that goes on from a checkpoint, it then has the checkpoint's content. Neither may move or
    // change its size. Throws InputError if the checkpoint has something else.
    void keep(const std::string& name, const BufferHandle& buffer);
    template <typename T>
    void keep_value(const std::string& name, T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        keep_part({name, nullptr, &value, sizeof value});
    }
    // For the caller of an integrator: whether each look at the film is to be kept as a state; the last one; and a state to go on from,
    // whose film has been restored.
    bool keeps_looks = false;
    const std::optional<SessionState>& last_look() const { return last_look_; }
    void go_on_from(SessionState state);

    // Work before the first pass that counts as rendering.
    void add_preparation(double seconds) { progress_.wall_s += seconds; }

    // Seconds of a phase ("eye_pass", "photon_tracing", ...).
    void add_phase(const std::string& name, double seconds) { phases_[name] += seconds; }
    const std::map<std::string, double>& phases() const { return phases_; }

    // Called with the film downloaded after a slice that ends at a power of two, after the last one, and at least every two
    // seconds. During on_look, look_mutex is held: other threads that hold it find what the last look found.
    std::function<void()> on_look;
    std::function<void(const RenderProgress&, const Film&)> on_progress;
    std::timed_mutex look_mutex;

 private:
    using Clock = std::chrono::steady_clock;
    struct KeptPart {
        std::string name;
        BufferHandle buffer;  // or else
        void* value;
        size_t bytes;
    };
    void keep_part(KeptPart part);
    SessionState state() const;
    void begin_to_go_on();
    void look();
    void apply_limits();
    TargetState compare_with_target(const FilmSummary& summary) const;
    BudgetLimits limits_;
    RenderProgress progress_;
    std::vector<ErrorPoint> history_;  // one point per evaluation of the film
    std::map<std::string, double> phases_, counts_;
    std::vector<std::pair<std::string, std::string>> choices_;
    Clock::time_point slice_start_{};
    uint64_t first_pass_ = 0;
    double seconds_per_pass_ = 0.0;
    double last_look_s_ = 0.0;
    bool interrupted_ = false;
    FilmSummary looked_;
    std::vector<KeptPart> kept_;
    std::optional<SessionState> last_look_;
    std::optional<SessionState> went_on_from_;  // until the first pass
};

}  // namespace lampyris

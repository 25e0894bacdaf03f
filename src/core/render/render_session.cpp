#include "core/render/render_session.h"

#include "core/base/error.h"
#include "core/base/watch.h"
#include "core/render/sample_slices.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace lampyris {
namespace {

constexpr double kLookSeconds = 2.0;

}  // namespace

RenderSession::RenderSession(Device& device_, const Scene& scene_, DeviceSceneHandle device_scene_, Film& film_,
                             BudgetLimits limits)
    : device(device_), scene(scene_), device_scene(std::move(device_scene_)), film(film_), limits_(limits) {
    progress_.estimated_error = std::numeric_limits<double>::quiet_NaN();
    progress_.forecast = forecast_halving({}, error_rate);
}

kernel::FilmWindow RenderSession::window(uint32_t first, uint32_t samples) const {
    const glm::uvec4 pixels = film.window();
    return {pixels.x, pixels.y, pixels.z, pixels.w, first, samples, seed, sampler};
}

void RenderSession::keep(const std::string& name, const BufferHandle& buffer) {
    keep_part({name, buffer, nullptr, buffer->size()});
}

void RenderSession::keep_part(KeptPart part) {
    if (went_on_from_) {
        const auto& parts = went_on_from_->parts;
        const auto found = std::ranges::find(parts, part.name, &SessionState::Part::name);
        if (found == parts.end() || found->bytes.size() != part.bytes)
            throw InputError(fmt::format("error: the checkpoint cannot be resumed: its \"{}\" is {}", part.name,
                                         found == parts.end() ? "missing" : "of another size"));
        if (part.buffer)
            part.buffer->upload(found->bytes.data(), part.bytes);
        else
            std::memcpy(part.value, found->bytes.data(), part.bytes);
    }
    kept_.push_back(std::move(part));
}

void RenderSession::go_on_from(SessionState state) {
    progress_.passes = state.passes;
    progress_.wall_s = last_look_s_ = state.wall_s;
    history_ = state.history;
    went_on_from_ = std::move(state);
}

SessionState RenderSession::state() const {
    SessionState now{progress_.passes, progress_.wall_s, history_, phases_, counts_, photons, {}};
    for (const KeptPart& part : kept_) {
        std::vector<std::byte> bytes(part.bytes);
        if (part.buffer)
            part.buffer->download(bytes.data(), bytes.size());
        else
            std::memcpy(bytes.data(), part.value, bytes.size());
        now.parts.push_back({part.name, std::move(bytes)});
    }
    return now;
}

// The integrator is ready. What it did for that, it had done before: those counts are the checkpoint's.
void RenderSession::begin_to_go_on() {
    progress_.wall_s = went_on_from_->wall_s;
    phases_ = went_on_from_->phases;
    counts_ = went_on_from_->counts;
    const PhotonStatistics& before = went_on_from_->photons;
    photons.emitted = before.emitted;
    photons.stored = before.stored;
    photons.lost = before.lost;
    photons.rays = before.rays;
    went_on_from_.reset();
    apply_limits();
    look();
}

uint32_t RenderSession::next_passes() {
    if (went_on_from_) begin_to_go_on();
    if (current_watch().interrupted()) interrupted_ = true;
    if (interrupted_ || progress_.finished) return 0;
    uint64_t count = 1;
    if (seconds_per_pass_ > 0.0)
        count = uint64_t(std::clamp(SampleSlices::kSliceSeconds / seconds_per_pass_, 1.0, 1048576.0));
    // At most twice as many as before: the first slices are short, and show how long a pass takes.
    count = std::min(count, std::max<uint64_t>(1, progress_.passes));
    if (limits_.seconds && seconds_per_pass_ > 0.0) {
        const double left = *limits_.seconds - progress_.wall_s;
        count = std::min(count, uint64_t(std::max(1.0, std::floor(left / seconds_per_pass_))));
    }
    const uint64_t next_power = std::bit_ceil(progress_.passes + 1);
    count = std::min(count, next_power - progress_.passes);
    if (max_slice > 0) count = std::min<uint64_t>(count, max_slice);
    if (limits_.passes) count = std::min(count, *limits_.passes - progress_.passes);
    if (count == 0) return 0;
    slice_start_ = Clock::now();
    return uint32_t(count);
}

void RenderSession::passes_finished(uint32_t count) {
    if (path_log) path_log->stop();
    const double seconds = std::chrono::duration<double>(Clock::now() - slice_start_).count();
    progress_.passes += count;
    progress_.wall_s += seconds;
    seconds_per_pass_ = seconds / count;
    apply_limits();
    if (current_watch().interrupted()) interrupted_ = true;
    const bool due = progress_.finished || interrupted_ || std::has_single_bit(progress_.passes) ||
                     progress_.wall_s - last_look_s_ >= kLookSeconds;
    if (due) look();
}

void RenderSession::apply_limits() {
    if (limits_.passes && progress_.passes >= *limits_.passes) progress_.finished = true;
    // The next pass must fit, or the limit would be exceeded by half a pass on average.
    if (limits_.seconds && progress_.wall_s + 0.5 * seconds_per_pass_ >= *limits_.seconds) progress_.finished = true;
}

void RenderSession::look() {
    std::unique_lock lock(look_mutex);
    last_look_s_ = progress_.wall_s;
    film.download();
    looked_ = film.summary();
    const FilmSummary& summary = looked_;
    progress_.estimated_error = summary.estimated_relmse;
    if (history_.empty() || history_.back().passes < progress_.passes)
        history_.push_back({progress_.passes, progress_.wall_s, summary.estimated_relmse});
    progress_.forecast = forecast_halving(history_, error_rate);
    progress_.unstable = why_unstable(summary.health, history_, error_rate);
    if (!unseen_error.empty()) progress_.unstable = unseen_error;
    progress_.rays = summary.rays;
    progress_.samples = summary.samples;
    progress_.target = compare_with_target(summary);
    if (progress_.target == TargetState::kReached) progress_.finished = true;
    if (keeps_looks) last_look_ = state();
    if (on_look) on_look();
    lock.unlock();
    if (on_progress) on_progress(progress_, film);
}

RenderEnd RenderSession::ended() const {
    if (interrupted_) return RenderEnd::kInterrupted;
    if (progress_.target == TargetState::kReached) return RenderEnd::kTargetError;
    return limits_.passes && progress_.passes >= *limits_.passes ? RenderEnd::kPasses : RenderEnd::kTime;
}

TargetState RenderSession::compare_with_target(const FilmSummary& summary) const {
    if (!limits_.target_error) return TargetState::kNone;
    // Even with accept_unstable the first estimate is not used: the picture may still be black.
    if (summary.min_samples < kTrustedSamples) return TargetState::kAbove;
    if (std::isnan(summary.estimated_relmse)) return TargetState::kUnknown;
    if (summary.estimated_relmse > *limits_.target_error) return TargetState::kAbove;
    if (!progress_.unstable.empty() && !limits_.accept_unstable) return TargetState::kBelowButUnstable;
    return TargetState::kReached;
}

}  // namespace lampyris

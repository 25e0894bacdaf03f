#include "commands/progress.h"

#include "commands/console.h"
#include "core/base/text.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace lampyris {

std::string duration_text(double seconds) {
    if (seconds < 0.9995) return fmt::format("{:.0f} ms", seconds * 1e3);
    if (seconds < 100.0) return fmt::format("{:.1f} s", seconds);
    const uint64_t whole = uint64_t(std::llround(seconds));
    if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
    return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

ProgressDisplay::ProgressDisplay(bool quiet, BudgetLimits limits)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0), limits_(limits) {}

std::string ProgressDisplay::error_text(const RenderProgress& progress) {
    if (!std::isfinite(progress.estimated_error)) return "error not known yet";
    if (progress.estimated_error == 0.0) return "no variance seen";
    const ErrorForecast& forecast = progress.forecast;
    const double percent = 100.0 * ErrorForecast::kConfidence;
    const std::string error = fmt::format("estimated relMSE {:.2e}, ", progress.estimated_error);
    // An upper bound this far away means no more than that there may be none.
    constexpr double kFar = 100.0;  // times what was spent so far
    if (forecast.high_s < kFar * progress.wall_s)
        return error + fmt::format("halving takes {} to {} more ({:.0f} %)", duration_text(forecast.low_s),
                                   duration_text(forecast.high_s), percent);
    if (std::isfinite(forecast.low_s))
        return error + fmt::format("halving takes at least {} more", duration_text(forecast.low_s));
    return error + "too early to predict its halving";
}

double ProgressDisplay::share_done(const RenderProgress& progress) const {
    double share = 0.0;
    if (limits_.passes)
        share = std::max(share, double(progress.passes) / double(std::max<uint64_t>(1, *limits_.passes)));
    if (limits_.seconds) share = std::max(share, progress.wall_s / *limits_.seconds);
    // Nobody can predict how long an estimate stays unstable.
    const bool counts = progress.unstable.empty() || limits_.accept_unstable;
    if (limits_.target_error && progress.estimated_error > 0.0 && counts)
        share = std::max(share, *limits_.target_error / progress.estimated_error);
    return progress.finished ? 1.0 : std::clamp(share, 0.0, 1.0);
}

std::string ProgressDisplay::target_text(const RenderProgress& progress) {
    switch (progress.target) {
        case TargetState::kNone: return {};
        case TargetState::kAbove: return "the target error was not reached";
        case TargetState::kUnknown: return "the target error was not reached: the error is not known";
        case TargetState::kBelowButUnstable:
            return "the target error was not reached: the estimate is below it, but unstable";
        case TargetState::kReached:
            return progress.unstable.empty() ? "the target error was reached"
                                             : "the target error was reached by an unstable estimate";
    }
    return {};
}

// Says once that rendering goes on past its target; if nothing else ends it, even with --quiet.
void ProgressDisplay::note_unstable_target(const RenderProgress& progress) {
    const bool endless = !limits_.passes && !limits_.seconds;
    const bool unknown = progress.target == TargetState::kUnknown;
    const bool stuck = unknown || progress.target == TargetState::kBelowButUnstable;
    if (noted_ || progress.finished || !stuck || (quiet_ && !endless)) return;
    noted_ = true;
    const std::string why = unknown ? "not known"
                                    : fmt::format("{:.2e}, below --target-error, but unstable: {}",
                                                  progress.estimated_error, progress.unstable);
    const std::string note = fmt::format(
        "note: after {} the estimated error is {}; rendering continues until this changes, or until {}{}\n",
        counted(progress.passes, "pass", "passes"), why, endless ? "Ctrl-C, which writes the image" : "another limit",
        unknown ? "" : "; --accept-unstable would have stopped here");
    terminal_ && !quiet_ ? tell_in_place(note) : tell_text(note);
}

void ProgressDisplay::show(const RenderProgress& progress) {
    note_unstable_target(progress);
    if (quiet_) return;
    const double share = share_done(progress);
    const double rate = progress.wall_s > 0.0 ? double(progress.samples) / progress.wall_s : 0.0;
    const std::string left =
        share > 0.0 ? fmt::format("{} left  ", duration_text(progress.wall_s * (1.0 - share) / share)) : "";
    const std::string line =
        fmt::format("{:3.0f} %  {}  {:.2f} Msamples/s  {}{}", share * 100.0, counted(progress.passes, "pass", "passes"),
                    rate * 1e-6, left, error_text(progress)) +
        (progress.unstable.empty() ? "" : fmt::format("; unstable: {}", progress.unstable));
    if (terminal_) {
        constexpr int kWidth = 20;
        const int filled = static_cast<int>(std::lround(share * kWidth));
        tell_in_place(
            fmt::format("[{:#<{}}{:-<{}}] {}{}", "", filled, "", kWidth - filled, line, progress.finished ? "\n" : ""));
        return;
    }
    // Ten seconds apart at least, so that a log stays short.
    if (!progress.finished && progress.wall_s - last_plain_s_ < 10.0) return;
    last_plain_s_ = progress.wall_s;
    tell("{}\n", line);
}

}  // namespace lampyris

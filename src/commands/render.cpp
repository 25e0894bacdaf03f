// lampyris render: reads a scene, writes images and their cost.
#include "commands/command.h"
#include "commands/compile_display.h"
#include "commands/console.h"
#include "commands/interrupt.h"
#include "commands/progress.h"
#include "commands/render_options.h"
#include "commands/replay.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/rescue.h"
#include "core/base/text.h"
#include "core/image/image_io.h"
#include "core/render/render.h"
#include "core/render/statistics.h"
#include "core/scene/scene_folder.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

namespace lampyris {
namespace {

std::vector<std::string> choose_outputs(const RenderOptions& options, const SceneSettings& settings) {
    std::vector<std::string> outputs = options.outputs;
    if (outputs.empty() && !options.request.replay) {
        if (settings.output.empty())
            throw InputError("error: no output: name an image with -o IMAGE.exr (or .pfm, .png)");
        // A stranger's scene does not choose which file of the user is replaced.
        if (!SceneFolder(".").why_refused(settings.output).empty())
            throw InputError(fmt::format(
                "error: the scene wants to write '{}', which is outside of the working folder: name an image with -o",
                shown(settings.output)));
        outputs.push_back(settings.output);
    }
    return outputs;
}

// Throws InputError if two of the files that are written are the same, or one is the scene or the reference: one would replace
// the other.
void check_distinct(const RenderOptions& options, const std::vector<std::string>& outputs) {
    std::vector<std::pair<std::string, std::string>> files;
    if (!options.request.scene.text) files.emplace_back("the scene", options.request.scene.name);
    for (const std::string& output : outputs) files.emplace_back("-o", output);
    files.emplace_back("--stats", options.statistics_file);
    files.emplace_back("--checkpoint", options.request.checkpoint);
    files.emplace_back("--reference", options.request.reference);
    std::map<std::string, std::pair<std::string, std::string>> seen;
    for (const auto& [option, file] : files) {
        std::error_code error;
        if (file.empty() || std::filesystem::is_character_file(file, error)) continue;
        const std::string place = real_path(file);
        const auto [found, is_new] = seen.try_emplace(place.empty() ? file : place, option, file);
        if (!is_new)
            throw InputError(fmt::format("error: {} '{}' and {} '{}' are the same file: one would replace the other",
                                         found->second.first, shown(found->second.second), option, shown(file)));
    }
}

void print_summary(const RunRecord& run, const std::vector<std::string>& outputs) {
    print("{}: {}, {}, {} ({} in all), {:.2f} Mrays/s on {}\n", shown(run.scene), run.integrator,
          counted(run.progress.passes, "pass", "passes"), duration_text(run.progress.wall_s),
          duration_text(run.total_s),
          run.progress.wall_s > 0.0 ? double(run.film.rays) / run.progress.wall_s * 1e-6 : 0.0, run.backend);
    print("{}\n", ProgressDisplay::error_text(run.progress));
    if (!run.progress.unstable.empty())
        print("the error estimate is unstable, the true error may be much larger: {}\n", run.progress.unstable);
    if (const std::string target = ProgressDisplay::target_text(run.progress); !target.empty()) print("{}\n", target);
    if (run.film.non_finite > 0)
        tell(
            "warning: left out {} that {} not finite, or too large to be added to the others; the first one is sample "
            "{} of "
            "pixel ({}, {}): look at it with --replay {},{},{}\n",
            counted(run.film.non_finite, "sample"), run.film.non_finite == 1 ? "was" : "were",
            run.film.first_non_finite[2], run.film.first_non_finite[0], run.film.first_non_finite[1],
            run.film.first_non_finite[0], run.film.first_non_finite[1], run.film.first_non_finite[2]);
    if (run.film.unknown_errors > 0)
        tell(
            "warning: the error of {} is not known, since squares of radiance there are beyond the range of a "
            "float: scale the lights down, and the exposure up\n",
            counted(run.film.unknown_errors, "pixel"));
    for (const std::string& output : outputs) print("wrote {}\n", output);
}

// Shows the library's messages on the console, and passes Ctrl-C to the library.
class ConsoleObserver final : public RenderObserver {
 public:
    explicit ConsoleObserver(const RenderOptions& options)
        : options_(options),
          compile_display_(options.quiet),
          interrupts_(options.outputs, *this, [this] { return write_so_far(); }) {}

    void warning(const std::string& text) override {
        if (!options_.quiet) tell("{}\n", text);
    }
    void note(const std::string& text) override {
        if (!options_.quiet) tell("note: {}\n", text);
    }
    void failure(const std::string& text) override { tell("{}\n", text); }
    void ready(const RenderPlan& plan) override {
        outputs_ = choose_outputs(options_, plan.settings);
        check_distinct(options_, outputs_);
        interrupts_.set_outputs(outputs_);
        for (const std::string& output : outputs_) check_image_output(output, options_.write);
        if (!options_.statistics_file.empty()) check_writable(options_.statistics_file);
        display_.emplace(options_.quiet || replays(), plan.limits);
    }
    void compiling(std::string_view kernel, bool begins) override { compile_display_.heard(kernel, begins); }
    void progress(const RenderProgress& progress, const Film&) override {
        if (!replays()) interrupts_.image_begins();
        display_->show(progress);
    }

    double wants_image_every() const override { return replays() || write_failed_ ? 0.0 : options_.every_s; }
    void image_so_far(const RenderOutcome& outcome) override {
        try {
            write(outcome);
        } catch (const MachineError& error) {
            write_failed_ = true;  // and is tried again at the end
            tell("warning: the image so far is not written any more: {}\n", error.what());
        }
    }

    void written() { interrupts_.written(); }
    void passes_end() override { interrupts_.writing_begins(); }
    void fails_after(const RenderOutcome& outcome) override {
        if (replays()) return;
        write(outcome);
        tell("the rendering failed: what there was after {} is written\n", passes_of(outcome));
    }

    // All of them, even if one cannot be written; then throws MachineError.
    void write(const RenderOutcome& outcome) const {
        std::string failures;
        const auto attempt = [&](const auto& write_one) {
            try {
                write_one();
            } catch (const MachineError& error) {
                failures += (failures.empty() ? "" : "\n") + std::string(error.what());
            }
        };
        for (const std::string& output : outputs_)
            attempt([&] {
                const WriteResult written = write_image(output, outcome.image, options_.write);
                if (written.clamped > 0)
                    tell("warning: {}: {} numbers were larger than a half float holds and were cut to 65504\n", output,
                         written.clamped);
            });
        if (!options_.statistics_file.empty())
            attempt([&] {
                const std::string text =
                    statistics_json(outcome.record).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) +
                    "\n";
                write_file_or_rescue(options_.statistics_file, std::as_bytes(std::span(text)), "file of statistics");
            });
        if (!failures.empty()) throw MachineError(failures);
    }

    const std::vector<std::string>& outputs() const { return outputs_; }

 private:
    static std::string passes_of(const RenderOutcome& outcome) {
        return counted(outcome.record.progress.passes, "pass", "passes");
    }
    // In another thread, while the rendering does not end. Returns the message to end with.
    std::string write_so_far() {
        constexpr std::chrono::milliseconds kPatience{200};
        try {
            const auto outcome = outcome_so_far(kPatience, true);
            if (!outcome) return "the pass does not end, and the film cannot be read: nothing is written";
            write(*outcome);
            return fmt::format("the pass does not end: what there was after {} is written", passes_of(*outcome));
        } catch (const std::exception& error) {
            return error.what();
        }
    }
    bool replays() const { return options_.request.replay.has_value(); }
    const RenderOptions& options_;
    CompileDisplay compile_display_;
    std::optional<ProgressDisplay> display_;
    std::vector<std::string> outputs_;
    bool write_failed_ = false;
    InterruptWatch interrupts_;  // the last one: its thread uses the others
};

int render(const RenderOptions& options) {
    ConsoleObserver observer(options);
    RenderOutcome outcome = render(options.request, observer);
    if (options.request.replay) {
        print_text(replay_text(outcome, *options.request.replay));
        return int(ExitCode::kDone);
    }
    observer.write(outcome);
    observer.written();
    if (!options.quiet) print_summary(outcome.record, observer.outputs());
    std::fflush(stdout);  // here, where a signal still ends the program if nobody reads it
    return int(outcome.record.ended == RenderEnd::kInterrupted ? ExitCode::kInterrupted : ExitCode::kDone);
}

void add_render(CLI::App& parent, std::function<int()>& run) {
    auto options = std::make_shared<RenderOptions>();
    CLI::App* command = parent.add_subcommand("render", "Render a scene: an image, its error and its cost");
    add_render_options(*command, *options);
    command->callback([&run, options] {
        run = [options] {
            options->finish();
            return render(*options);
        };
    });
}

REGISTER_COMMAND(add_render);

}  // namespace
}  // namespace lampyris

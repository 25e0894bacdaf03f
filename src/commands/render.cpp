// lampyris render: a scene in, images and their cost out.
#include "commands/command.h"
#include "commands/compile_display.h"
#include "commands/console.h"
#include "commands/interrupt.h"
#include "commands/progress.h"
#include "commands/render_options.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "core/image/metrics.h"
#include "core/integrator_choice.h"
#include "core/photon_map.h"
#include "core/plugin.h"
#include "core/scene/build.h"
#include "core/statistics.h"
#include "core/text.h"
#include "core/watch.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <chrono>
#include <cstdio>
#include <memory>

namespace lampyris {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// What the command line says of the integrator, over what the scene says.
ChosenIntegrator choose_integrator(const RenderOptions& options, BuiltScene& built, Diagnostics& diagnostics) {
    ChosenIntegrator chosen = choose_integrator(built, options.integrator_choice, diagnostics);
    if (!chosen.integrator) return chosen;
    if (!options.photon_map.empty()) {
        if (!chosen.integrator->uses_photon_map())
            throw InputError(
                fmt::format("error: --photon-map: integrator \"{}\" does not use a photon map", chosen.name));
        chosen.photon_map = options.photon_map;
    }
    if (chosen.integrator->uses_photon_map())
        create_photon_map(chosen.photon_map);  // says what is wrong with it, early
    return chosen;
}

// Radii that stay as they are leave a bias that no pass takes away: alpha is 1 there.
ErrorRate error_rate(const ChosenIntegrator& chosen) {
    if (!chosen.integrator->uses_photon_map()) return ErrorRate::of_samples();
    for (const auto& [name, value] : show_parameters(chosen.integrator->parameters(), *chosen.fields))
        if (name == "alpha") return ErrorRate::of_photons(std::stod(value));
    return ErrorRate::of_photons(1.0);
}

// What ends the rendering: the command line's limits, or the scene's samples.
BudgetLimits choose_limits(const RenderOptions& options, const ChosenIntegrator& chosen, const SceneSettings& settings,
                           const std::string& unseen_error) {
    if (options.replay) return {1, {}, {}};
    BudgetLimits limits = options.limits;
    if (chosen.integrator->fixes_eye_samples()) limits.passes = options.pass_limit();
    if (limits.passes || limits.seconds) return limits;
    if (!limits.target_error) {
        limits.passes = uint64_t(settings.samples_per_pixel);
    } else if (!unseen_error.empty() && !limits.accept_unstable) {
        throw InputError(fmt::format(
            "error: --target-error alone would never stop: with integrator \"{}\" the estimated error stays "
            "unstable, because {}; give another limit, too (--passes or --time), or take the estimate as it "
            "is (--accept-unstable)",
            chosen.name, unseen_error));
    }
    return limits;
}

std::vector<std::string> choose_outputs(const RenderOptions& options, const SceneSettings& settings) {
    std::vector<std::string> outputs = options.outputs;
    if (outputs.empty() && !options.replay) {
        if (settings.output.empty())
            throw InputError("error: no output: name an image with -o IMAGE.exr (or .pfm, .png)");
        outputs.push_back(settings.output);
    }
    return outputs;
}

void print_summary(const RunRecord& run, const std::vector<std::string>& outputs) {
    print("{}: {}, {}, {} ({} in all), {:.2f} Mrays/s on {}\n", run.scene, run.integrator,
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

// One sample of one pixel, alone: for debugging, and for comparing backends.
void print_replay(const RenderSession& session, const RenderOptions& options) {
    const kernel::FilmPixel& p = session.film.pixels()[0];
    const nlohmann::ordered_json json = {{"schema", "lampyris.replay/1"},
                                         {"pixel", {(*options.replay)[0], (*options.replay)[1]}},
                                         {"pass", (*options.replay)[2]},
                                         {"backend", session.device.backend()},
                                         {"radiance", {p.sum.x, p.sum.y, p.sum.z}},
                                         {"weight", p.sum.w},
                                         {"rays", p.counts.y},
                                         {"non_finite", p.counts.z},
                                         {"normal", {p.normal.x, p.normal.y, p.normal.z}},
                                         {"albedo", {p.albedo.x, p.albedo.y, p.albedo.z}},
                                         {"depth", p.squares.w}};
    print("{}\n", json.dump(2));
}

int render(const RenderOptions& options) {
    const Clock::time_point program_start = Clock::now();
    InterruptWatch interrupts(options.outputs);
    RunRecord run;
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    diagnostics.set_skip_unsupported(options.skip_unsupported);
    SceneDescription description = parse_scene_file(options.scene, sources, diagnostics);
    run.parse_s = seconds_since(program_start);
    const Clock::time_point scene_start = Clock::now();
    BuiltScene built = build_scene(std::move(description), options.build, diagnostics);
    ChosenIntegrator chosen = choose_integrator(options, built, diagnostics);
    if (!options.quiet)
        for (const std::string& warning : diagnostics.warnings()) tell("{}\n", warning);
    if (!options.quiet && !diagnostics.has_errors())
        for (const std::string& note : built.scene.notes) tell("note: {}\n", note);
    diagnostics.throw_if_errors();
    built.scene.unsupported = diagnostics.unsupported_list();
    run.scene_s = seconds_since(scene_start);

    if (options.replay) {
        const auto [x, y, pass] = *options.replay;
        if (x < 0 || y < 0 || x >= int(built.scene.width()) || y >= int(built.scene.height()))
            throw InputError(fmt::format("error: --replay {},{},{}: the picture has {}x{} pixels", x, y, pass,
                                         built.scene.width(), built.scene.height()));
        built.settings.crop = {x, y, x + 1, y + 1};
    }
    const std::vector<std::string> outputs = choose_outputs(options, built.settings);
    interrupts.set_outputs(outputs);
    for (const std::string& output : outputs) check_image_output(output, options.write);
    if (!options.statistics_file.empty()) check_writable(options.statistics_file);
    std::optional<std::vector<float>> reference;
    const std::array<int, 4>& crop = built.settings.crop;
    if (!options.reference.empty()) {
        Image image = read_image(options.reference, {true, true});
        const int width = crop[2] - crop[0], height = crop[3] - crop[1];
        if (image.width == int(built.scene.width()) && image.height == int(built.scene.height()))
            image = image.crop({crop[0], crop[1], crop[2], crop[3]});
        if (image.width != width || image.height != height)
            throw InputError(fmt::format("error: {}: the reference has {} pixels, the picture {}x{}", options.reference,
                                         image.size_text(), width, height));
        reference = std::move(image.pixels);
    }

    const uint32_t eye_samples = chosen.integrator->fixes_eye_samples() ? options.eye_samples.value_or(1) : 1;
    const std::string unseen_error = chosen.integrator->unseen_error(eye_samples);
    const BudgetLimits limits = choose_limits(options, chosen, built.settings, unseen_error);
    const CompileDisplay compile_display(options.quiet);
    const std::unique_ptr<Device> device = create_device(options.backend, options.device);
    const DeviceSceneHandle device_scene = device->upload(built.scene);
    Film film(*device, built.scene, crop);
    RenderSession session(*device, built.scene, device_scene, film, limits);
    session.photon_map = chosen.photon_map;
    session.error_rate = error_rate(chosen);
    session.eye_samples = eye_samples;
    session.unseen_error = unseen_error;
    session.seed = options.seed.value_or(built.settings.seed);
    session.sampler = built.settings.sampler == "independent" ? kernel::SAMPLER_INDEPENDENT : kernel::SAMPLER_SOBOL;
    if (options.replay) session.start_at(uint64_t((*options.replay)[2]));
    ProgressDisplay display(options.quiet || options.replay.has_value(), limits);
    session.on_progress = [&](const RenderProgress& progress, const Film& current) {
        if (!options.replay) interrupts.image_begins();
        ConvergencePoint point{progress.wall_s,
                               progress.passes,
                               progress.estimated_error,
                               progress.forecast,
                               !progress.unstable.empty(),
                               {}};
        if (reference) point.against_reference = measure(current.rgb(), *reference);
        run.convergence.push_back(point);
        display.show(progress);
    };
    try {
        chosen.integrator->render(session);
    } catch (const Cancelled&) {
        session.pass_was_cancelled();
    }

    film.download();
    if (options.replay) {
        print_replay(session, options);
        return int(ExitCode::kDone);
    }
    run.scene = options.scene;
    run.integrator = chosen.name;
    run.integrator_asked = chosen.asked;
    run.integrator_parameters = show_parameters(chosen.integrator->parameters(), *chosen.fields);
    if (!built.settings.media) run.integrator_parameters.emplace_back("media", "off");
    run.backend = device->backend();
    run.device = device->description();
    run.threads = device->threads();
    run.seed = session.seed;
    run.sampler = built.settings.sampler;
    run.resolution = {int(built.scene.width()), int(built.scene.height())};
    run.crop = crop;
    run.film = film.summary();
    run.film.rays += session.photons.rays;
    if (chosen.integrator->uses_photon_map()) {
        run.photon_map = parse_plugin_choice(chosen.photon_map).name;
        run.photons = session.photons;
    }
    run.samples_per_pixel = double(run.film.samples) / double(film.pixel_count());
    run.progress = session.progress();
    run.phases = session.phases();
    run.device_statistics = device->statistics();
    run.interrupted = session.interrupted();
    run.total_s = seconds_since(program_start);

    Image image = film.image();
    image.metadata = image_metadata(run, built.scene);
    for (const std::string& output : outputs) {
        const WriteResult written = write_image(output, image, options.write);
        if (written.clamped > 0)
            tell("warning: {}: {} numbers were larger than a half float holds and were cut to 65504\n", output,
                 written.clamped);
    }
    if (!options.statistics_file.empty())
        write_file_atomically(options.statistics_file, statistics_json(run, built.scene).dump(2) + "\n");
    if (!options.quiet) print_summary(run, outputs);
    return int(run.interrupted ? ExitCode::kInterrupted : ExitCode::kDone);
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

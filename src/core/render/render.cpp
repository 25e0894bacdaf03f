#include "core/render/render.h"

#include "core/base/plugin.h"
#include "core/image/image_io.h"
#include "core/render/checkpoint.h"
#include "core/render/integrator_choice.h"
#include "core/render/statistics.h"
#include "core/scene/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace lampyris {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void check(const RenderRequest& request) {
    if (request.build.resolution) {
        const auto [width, height] = *request.build.resolution;
        if (std::min(width, height) < 1 || std::max(width, height) > kLargestSide)
            throw InputError(
                fmt::format("error: --resolution {}x{}: sides are 1 to {} pixels", width, height, kLargestSide));
    }
    const BudgetLimits& limits = request.limits;
    if (limits.passes == 0u || request.samples_per_pixel == 0u)
        throw InputError("error: a limit of passes or samples must be at least 1");
    if (limits.seconds && !(*limits.seconds > 0.0)) throw InputError("error: a time limit must be above 0 seconds");
    if (limits.target_error && !(*limits.target_error > 0.0)) throw InputError("error: --target-error must be above 0");
    if (request.resume && request.checkpoint.empty())
        throw InputError("error: --resume goes on from a checkpoint: name it with --checkpoint FILE");
    if (!request.checkpoint.empty() && request.replay)
        throw InputError("error: --replay renders one sample of one pixel, and has no checkpoint");
    if (!(request.checkpoint_every_s > 0.0)) throw InputError("error: --every must be above 0 seconds");
}

// The request's settings of the integrator. `media` is removed: every integrator accepts it, and the scene's builder uses it.
PluginChoice requested_integrator(const RenderRequest& request, BuildOptions& build) {
    PluginChoice choice;
    if (!request.integrator.empty()) choice = parse_plugin_choice(request.integrator);
    choice.settings.insert(choice.settings.end(), request.integrator_settings.begin(),
                           request.integrator_settings.end());
    for (const auto& [key, value] : choice.settings) {
        if (key != "media") continue;
        if (value != "on" && value != "off")
            throw InputError(fmt::format("error: integrator.media={}: expected on or off", shown(value)));
        build.media = value == "on";
    }
    std::erase_if(choice.settings, [](const auto& setting) { return setting.first == "media"; });
    return choice;
}

ChosenIntegrator choose(const RenderRequest& request, const PluginChoice& choice, BuiltScene& built,
                        Diagnostics& diagnostics) {
    ChosenIntegrator chosen = choose_integrator(built, choice, diagnostics);
    if (!chosen.integrator) return chosen;
    if (!request.photon_map.empty()) {
        if (!chosen.integrator->uses_photon_map())
            throw InputError(
                fmt::format("error: --photon-map: integrator \"{}\" does not use a photon map", chosen.name));
        chosen.photon_map = request.photon_map;
    }
    if (chosen.integrator->uses_photon_map()) create_photon_map(chosen.photon_map);  // reports errors early
    return chosen;
}

// The limits of the rendering: those of the request, or the scene's number of samples.
BudgetLimits choose_limits(const RenderRequest& request, const ChosenIntegrator& chosen, const SceneSettings& settings,
                           const std::string& unseen_error) {
    if (request.replay) return {1, {}, {}};
    BudgetLimits limits = request.limits;
    if (request.samples_per_pixel && !chosen.integrator->fixes_eye_samples())
        limits.passes =
            std::min<uint64_t>(limits.passes.value_or(*request.samples_per_pixel), *request.samples_per_pixel);
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

void apply_replay(const std::array<int, 3>& replay, BuiltScene& built) {
    const auto [x, y, pass] = replay;
    if (x < 0 || y < 0 || pass < 0 || x >= int(built.scene.width()) || y >= int(built.scene.height()))
        throw InputError(fmt::format("error: --replay {},{},{}: the picture has {}x{} pixels", x, y, pass,
                                     built.scene.width(), built.scene.height()));
    built.settings.crop = {x, y, x + 1, y + 1};
}

uint32_t sampler_number(const std::string& name) {
    if (name == "independent") return kernel::SAMPLER_INDEPENDENT;
    if (name == "sobol") return kernel::SAMPLER_SOBOL;
    throw InputError(
        fmt::format("error: unknown sampler \"{}\"; there are \"independent\" and \"sobol\"", shown(name)));
}

// R, G, B of the rendered pixels.
std::vector<float> read_reference(const std::string& file, const BuiltScene& built) {
    const std::array<int, 4>& crop = built.settings.crop;
    Image image = read_image(file, {true, true});
    const int width = crop[2] - crop[0], height = crop[3] - crop[1];
    if (image.width == int(built.scene.width()) && image.height == int(built.scene.height()))
        image = image.crop({crop[0], crop[1], crop[2], crop[3]});
    if (image.width != width || image.height != height)
        throw InputError(fmt::format("error: {}: the reference has {} pixels, the picture {}x{}", file,
                                     image.size_text(), width, height));
    return std::move(image.pixels);
}

// Writes the checkpoint of a rendering, if it has one. What cannot be written is told, and the rendering goes on.
class CheckpointKeeper {
 public:
    CheckpointKeeper(const RenderRequest& request, RenderObserver& observer, RenderIdentity identity)
        : request_(request), observer_(observer), identity_(std::move(identity)) {}

    bool is_due() const { return seconds_since(last_) >= request_.checkpoint_every_s; }
    // The state at the session's last look at the film, if it has not been written yet.
    void keep(const RenderSession& session, const Film& film, const std::vector<ConvergencePoint>& convergence,
              double total_s) {
        if (request_.checkpoint.empty() || !session.last_look()) return;
        const SessionState& state = *session.last_look();
        if (state.passes == written_passes_) return;
        last_ = Clock::now();
        try {
            write_checkpoint(request_.checkpoint, {identity_, state, convergence, total_s, film.pixels()});
            written_passes_ = state.passes;
        } catch (const MachineError& error) {
            observer_.failure(fmt::format("warning: the checkpoint is not up to date: {}", error.what()));
        }
    }

 private:
    const RenderRequest& request_;
    RenderObserver& observer_;
    const RenderIdentity identity_;
    uint64_t written_passes_ = 0;
    Clock::time_point last_ = Clock::now();
};

// Clears the interruption, however a run ends.
class EndOfInterruption {
 public:
    explicit EndOfInterruption(Watch& watch) : watch_(watch) {}
    ~EndOfInterruption() { watch_.interruption_ends(); }
    EndOfInterruption(const EndOfInterruption&) = delete;
    EndOfInterruption& operator=(const EndOfInterruption&) = delete;

 private:
    Watch& watch_;
};

}  // namespace

struct Rendering::State {
    State(RenderRequest wanted, RenderObserver* watching);
    RenderOutcome run(uint32_t seed);

    const Clock::time_point start = Clock::now();
    RenderRequest request;  // without its scene, once that has been read
    RenderObserver nobody;
    RenderObserver& observer;
    LoadedScene loaded;
    ChosenIntegrator chosen;
    uint32_t sampler = 0, eye_samples = 1;
    std::string unseen_error;
    BudgetLimits limits;
    std::optional<std::vector<float>> reference;
    std::optional<Checkpoint> resumed;
    double scene_s = 0.0, setup_s = 0.0;
    std::shared_ptr<Device> device;
    DeviceSceneHandle device_scene;

 private:
    void load();
    RenderIdentity identity(uint32_t seed) const;
    RunRecord record_of(const RenderSession& session) const;
    // The film as it was last downloaded.
    RenderOutcome outcome_of(const RenderSession& session, const Film& film,
                             const std::vector<ConvergencePoint>& convergence, double total_s) const;
};

Rendering::State::State(RenderRequest wanted, RenderObserver* watching)
    : request(std::move(wanted)), observer(watching ? *watching : nobody) {
    const WatchScope scope(observer);
    check(request);
    load();
    if (request.effects) {
        loaded.scene.effects.ask(request.effects, "the request");
        loaded.scene.record_effects(loaded.scene.effects.mask());
    }
    if (request.replay) {
        apply_replay(*request.replay, loaded);
        loaded.scene.effects.ask_path_log();
        loaded.scene.record_effects(loaded.scene.effects.mask());
    }
    if (request.sampler) loaded.settings.sampler = *request.sampler;
    if (request.seed) loaded.settings.seed = *request.seed;
    sampler = sampler_number(loaded.settings.sampler);
    if (chosen.integrator->fixes_eye_samples()) eye_samples = request.samples_per_pixel.value_or(1);
    unseen_error = chosen.integrator->unseen_error(eye_samples);
    limits = choose_limits(request, chosen, loaded.settings, unseen_error);
    observer.ready({loaded.scene, loaded.settings, limits});
    if (!request.reference.empty()) reference = read_reference(request.reference, loaded);
    device = request.device ? request.device : create_device(request.backend, request.device_options);
    if (!request.checkpoint.empty()) {
        check_checkpoint_file(request.checkpoint, request.resume);
        if (request.resume) resumed = read_checkpoint(request.checkpoint);
        if (request.resume && !resumed)
            observer.note(
                fmt::format("there is no checkpoint '{}' yet: the rendering begins anew", request.checkpoint));
    }
    device_scene = device->upload(loaded.scene);
    setup_s = seconds_since(start);
}

void Rendering::State::load() {
    BuildOptions build = request.build;
    const PluginChoice choice = requested_integrator(request, build);
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    diagnostics.set_skip_unsupported(request.skip_unsupported);
    loaded = read_scene(std::move(request.scene), build, std::move(sources), diagnostics);
    const Clock::time_point choice_start = Clock::now();
    chosen = choose(request, choice, loaded, diagnostics);
    for (const std::string& warning : diagnostics.warnings()) observer.warning(warning);
    if (!diagnostics.has_errors())
        for (const std::string& note : loaded.scene.notes) observer.note(note);
    diagnostics.throw_if_errors();
    loaded.scene.unsupported = diagnostics.unsupported_list();
    scene_s = loaded.build_s + seconds_since(choice_start);
}

RenderOutcome Rendering::State::run(uint32_t seed) {
    const Clock::time_point run_start = Clock::now();
    const WatchScope scope(observer);
    const EndOfInterruption end(observer);
    Film film(*device, loaded.scene, loaded.settings.crop);
    RenderSession session(*device, loaded.scene, device_scene, film, limits);
    session.photon_map = chosen.photon_map;
    session.error_rate = chosen.integrator->error_rate();
    session.eye_samples = eye_samples;
    session.unseen_error = unseen_error;
    session.seed = seed;
    session.sampler = sampler;
    session.max_slice = request.max_slice;
    session.start_at(request.replay ? uint64_t((*request.replay)[2]) : request.first_pass);
    std::optional<PathLogger> path_log;
    if (request.replay) session.path_log = &path_log.emplace(*device);
    session.on_note = [&](const std::string& text) { observer.note(text); };
    std::vector<ConvergencePoint> convergence;
    double earlier_s = setup_s;  // before this run
    if (resumed) {
        check_same_rendering(request.checkpoint, resumed->identity, identity(seed));
        film.restore(resumed->film);
        convergence = std::move(resumed->convergence);
        earlier_s += resumed->total_s;
        session.go_on_from(std::move(resumed->session));
        resumed.reset();  // a second run starts afresh
    }
    session.keeps_looks = !request.checkpoint.empty();
    const auto total_s = [&] { return earlier_s + seconds_since(run_start); };
    CheckpointKeeper keeper(request, observer, identity(seed));
    Clock::time_point last_image = run_start;
    session.on_progress = [&](const RenderProgress& progress, const Film& current) {
        if (convergence.empty() || convergence.back().passes < progress.passes) {
            ConvergencePoint point{progress.wall_s,
                                   progress.passes,
                                   progress.estimated_error,
                                   progress.forecast,
                                   !progress.unstable.empty(),
                                   {}};
            if (reference) point.against_reference = measure(current.rgb(), *reference);
            convergence.push_back(point);
        }
        observer.progress(progress, current);
        if (keeper.is_due()) keeper.keep(session, current, convergence, total_s());
        const double every = observer.wants_image_every();
        if (every > 0.0 && !progress.finished && seconds_since(last_image) >= every) {
            observer.image_so_far(outcome_of(session, current, convergence, total_s()));
            last_image = Clock::now();
        }
    };
    try {
        chosen.integrator->render(session);
    } catch (const Cancelled&) {
        session.pass_was_cancelled();
    }
    keeper.keep(session, film, convergence, total_s());  // before the film gets a part of a pass that was cut short
    film.download();
    RenderOutcome outcome = outcome_of(session, film, convergence, total_s());
    outcome.pixels = film.take_pixels();
    if (path_log) outcome.paths = path_log->log();
    return outcome;
}

RenderOutcome Rendering::State::outcome_of(const RenderSession& session, const Film& film,
                                           const std::vector<ConvergencePoint>& convergence, double total_s) const {
    RenderOutcome outcome;
    outcome.record = record_of(session);
    outcome.record.convergence = convergence;
    outcome.record.total_s = total_s;
    outcome.image = film.image();
    for (const ImageLayer& layer : session.layers)
        outcome.image.add_channels({layer.name + ".R", layer.name + ".G", layer.name + ".B"}, layer.rgb);
    outcome.image.metadata = image_metadata(outcome.record);
    return outcome;
}

RenderIdentity Rendering::State::identity(uint32_t seed) const {
    const auto& crop = loaded.settings.crop;
    RenderIdentity identity{
        {"version", std::string(plugin_abi())},
        {"scene", fmt::format("{:016x}", loaded.scene.hash)},
        {"resolution", fmt::format("{}x{}", loaded.scene.width(), loaded.scene.height())},
        {"crop", fmt::format("{}", fmt::join(crop, ","))},
        {"integrator", chosen.name},
        {"photon map", chosen.integrator->uses_photon_map() ? chosen.photon_map : ""},
        {"sampler", loaded.settings.sampler},
        {"seed", std::to_string(seed)},
        {"eye samples", std::to_string(eye_samples)},
        {"first pass", std::to_string(request.first_pass)},
        {"media", loaded.settings.media ? "on" : "off"},
        {"backend", device->backend()},
    };
    for (const auto& [name, value] : show_parameters(chosen.integrator->parameters(), *chosen.fields))
        identity.emplace_back(fmt::format("integrator.{}", name), value);
    return identity;
}

RunRecord Rendering::State::record_of(const RenderSession& session) const {
    const Scene& scene = loaded.scene;
    RunRecord run;
    run.scene = scene.name;
    run.scene_hash = scene.hash;
    run.effects = scene.effects.requests();
    run.notes = scene.notes;
    run.unsupported = scene.unsupported;
    run.integrator = chosen.name;
    run.integrator_asked = chosen.asked;
    run.integrator_parameters = show_parameters(chosen.integrator->parameters(), *chosen.fields);
    if (!loaded.settings.media) run.integrator_parameters.emplace_back("media", "off");
    run.backend = device->backend();
    run.device = device->description();
    run.threads = device->threads();
    run.seed = session.seed;
    run.sampler = loaded.settings.sampler;
    run.resolution = {int(scene.width()), int(scene.height())};
    run.crop = loaded.settings.crop;
    run.film = session.film.summary();
    run.film.rays += session.photons.rays;
    if (chosen.integrator->uses_photon_map()) {
        run.photon_map = parse_plugin_choice(chosen.photon_map).name;
        run.photons = session.photons;
    }
    run.samples_per_pixel = double(run.film.samples) / double(session.film.pixel_count());
    run.progress = session.progress();
    run.ended = session.ended();
    run.phases = session.phases();
    run.counts = session.counts();
    run.choices = session.choices();
    run.device_statistics = device->statistics();
    run.parse_s = loaded.parse_s;
    run.scene_s = scene_s;
    return run;
}

Rendering::Rendering(RenderRequest request) : state_(std::make_unique<State>(std::move(request), nullptr)) {}

Rendering::Rendering(RenderRequest request, RenderObserver& observer)
    : state_(std::make_unique<State>(std::move(request), &observer)) {}

Rendering::~Rendering() = default;

RenderOutcome Rendering::run() { return run(state_->loaded.settings.seed); }

RenderOutcome Rendering::run(uint32_t seed) { return state_->run(seed); }

const Scene& Rendering::scene() const { return state_->loaded.scene; }

const SceneSettings& Rendering::settings() const { return state_->loaded.settings; }

RenderOutcome render(const RenderRequest& request) { return Rendering(request).run(); }

RenderOutcome render(const RenderRequest& request, RenderObserver& observer) {
    return Rendering(request, observer).run();
}

}  // namespace lampyris

#include "core/render/render.h"

#include "core/base/memory.h"
#include "core/base/plugin.h"
#include "core/render/checkpoint.h"
#include "core/render/request.h"
#include "core/render/statistics.h"

#include <fmt/format.h>

#include <chrono>
#include <utility>

namespace lampyris {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

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
        const std::unique_lock lock(mutex_, std::try_to_lock);
        if (!lock) return;  // the other thread writes it
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
    std::mutex mutex_;
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
    RenderIdentity identity(uint32_t seed) const;
    RunRecord record_of(const RenderSession& session, const FilmSummary& film) const;

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
};

Rendering::State::State(RenderRequest wanted, RenderObserver* watching)
    : request(std::move(wanted)), observer(watching ? *watching : nobody) {
    const WatchScope scope(observer);
    check(request);
    load();
    if (request.effects) loaded.scene.effects.ask(request.effects, "the request");
    if (request.replay) {
        apply_replay(*request.replay, loaded);
        loaded.scene.effects.ask_path_log();
    }
    if (request.effects || request.replay) loaded.scene.record_effects(loaded.scene.effects.mask());
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
    check_process_memory(request.max_process_memory);
    setup_s = seconds_since(start);
}

void Rendering::State::load() {
    BuildOptions build = request.build;
    const PluginChoice choice = requested_integrator(request, build);
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    diagnostics.set_skip_unsupported(request.skip_unsupported);
    diagnostics.set_max_memory(request.max_process_memory);
    loaded = read_scene(std::move(request.scene), build, std::move(sources), diagnostics);
    const Clock::time_point choice_start = Clock::now();
    chosen = choose(request, choice, loaded, diagnostics);
    for (const std::string& warning : diagnostics.warnings()) observer.warning(warning);
    if (!diagnostics.has_errors())
        for (const std::string& note : loaded.scene.notes) observer.note(note);
    diagnostics.throw_if_errors();
    loaded.scene.unsupported = diagnostics.unsupported_list();
    scene_s = loaded.build_s + seconds_since(choice_start);
    check_process_memory(request.max_process_memory);
}

// The film and the session of one run, and what is kept beside them.
struct Rendering::Run {
    Run(State& rendering, uint32_t seed);
    ~Run();
    RenderOutcome outcome();

 private:
    void look();
    void progress(const RenderProgress& progress);
    std::optional<RenderOutcome> so_far(std::chrono::milliseconds patience, bool ends);
    void keep_before_failing();
    RenderOutcome outcome_of(const RunRecord& record, bool with_layers) const;
    double total_s() const { return earlier_s_ + seconds_since(start_); }

    const Clock::time_point start_ = Clock::now();
    State& state_;
    RenderObserver& observer_;
    Film film_;
    RenderSession session_;
    CheckpointKeeper keeper_;
    std::optional<PathLogger> path_log_;
    double earlier_s_;  // before this run
    std::vector<ConvergencePoint> convergence_;
    RunRecord looked_;  // of the last look
    Clock::time_point last_image_ = start_;
};

Rendering::Run::Run(State& state, uint32_t seed)
    : state_(state),
      observer_(state.observer),
      film_(*state.device, state.loaded.scene, state.loaded.settings.crop),
      session_(*state.device, state.loaded.scene, state.device_scene, film_, state.limits),
      keeper_(state.request, state.observer, state.identity(seed)),
      earlier_s_(state.setup_s) {
    const RenderRequest& request = state.request;
    session_.photon_map = state.chosen.photon_map;
    session_.error_rate = state.chosen.integrator->error_rate();
    session_.eye_samples = state.eye_samples;
    session_.unseen_error = state.unseen_error;
    session_.seed = seed;
    session_.sampler = state.sampler;
    session_.max_slice = request.max_slice;
    session_.start_at(request.replay ? uint64_t((*request.replay)[2]) : request.first_pass);
    if (request.replay) session_.path_log = &path_log_.emplace(*state.device);
    session_.on_note = [this](const std::string& text) { observer_.note(text); };
    if (state.resumed) {
        check_same_rendering(request.checkpoint, state.resumed->identity, state.identity(seed));
        film_.restore(state.resumed->film);
        convergence_ = std::move(state.resumed->convergence);
        earlier_s_ += state.resumed->total_s;
        session_.go_on_from(std::move(state.resumed->session));
        state.resumed.reset();  // a second run starts afresh
    }
    session_.keeps_looks = !request.checkpoint.empty();
    session_.on_look = [this] { look(); };
    session_.on_progress = [this](const RenderProgress& now, const Film&) { progress(now); };
    observer_.let_ask([this](std::chrono::milliseconds patience, bool ends) { return so_far(patience, ends); });
}

Rendering::Run::~Run() { observer_.let_ask({}); }

void Rendering::Run::look() {
    const RenderProgress& progress = session_.progress();
    if (convergence_.empty() || convergence_.back().passes < progress.passes) {
        ConvergencePoint point{progress.wall_s,
                               progress.passes,
                               progress.estimated_error,
                               progress.forecast,
                               !progress.unstable.empty(),
                               {}};
        if (state_.reference) point.against_reference = measure(film_.rgb(), *state_.reference);
        convergence_.push_back(point);
    }
    looked_ = state_.record_of(session_, session_.looked());
    looked_.convergence = convergence_;
    looked_.total_s = total_s();
}

void Rendering::Run::progress(const RenderProgress& progress) {
    if (!progress.finished) check_process_memory(state_.request.max_process_memory);
    observer_.progress(progress, film_);
    if (keeper_.is_due()) keeper_.keep(session_, film_, convergence_, total_s());
    const double every = observer_.wants_image_every();
    if (every <= 0.0 || progress.finished || seconds_since(last_image_) < every) return;
    observer_.image_so_far(outcome_of(looked_, true));
    last_image_ = Clock::now();
}

std::optional<RenderOutcome> Rendering::Run::so_far(std::chrono::milliseconds patience, bool ends) {
    const std::unique_lock lock(session_.look_mutex, patience);
    if (!lock || looked_.progress.passes == 0) return std::nullopt;
    RenderOutcome outcome = outcome_of(looked_, false);
    outcome.record.ended = RenderEnd::kInterrupted;
    if (ends) keeper_.keep(session_, film_, looked_.convergence, looked_.total_s);
    return outcome;
}

// Whatever fails here is less than what failed before.
void Rendering::Run::keep_before_failing() {
    try {
        keeper_.keep(session_, film_, convergence_, total_s());
        if (const auto outcome = so_far({}, false)) observer_.fails_after(*outcome);
    } catch (const std::exception& error) {
        observer_.failure(fmt::format("warning: what was rendered before is lost: {}", error.what()));
    }
}

RenderOutcome Rendering::Run::outcome() {
    try {
        state_.chosen.integrator->render(session_);
    } catch (const Cancelled&) {
        session_.pass_was_cancelled();
    } catch (...) {
        observer_.passes_end();
        keep_before_failing();
        throw;
    }
    observer_.passes_end();
    keeper_.keep(session_, film_, convergence_, total_s());  // before the film gets a part of a pass that was cut short
    film_.download();
    RunRecord record = state_.record_of(session_, film_.summary());
    record.convergence = convergence_;
    record.total_s = total_s();
    RenderOutcome outcome = outcome_of(record, true);
    outcome.pixels = film_.take_pixels();
    if (path_log_) outcome.paths = path_log_->log();
    return outcome;
}

// The film as it was last downloaded.
RenderOutcome Rendering::Run::outcome_of(const RunRecord& record, bool with_layers) const {
    RenderOutcome outcome;
    outcome.record = record;
    outcome.image = film_.image();
    if (with_layers)
        for (const ImageLayer& layer : session_.layers)
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

RunRecord Rendering::State::record_of(const RenderSession& session, const FilmSummary& film) const {
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
    run.film = film;
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

RenderOutcome Rendering::run(uint32_t seed) {
    const WatchScope scope(state_->observer);
    const EndOfInterruption end(state_->observer);
    return Run(*state_, seed).outcome();
}

const Scene& Rendering::scene() const { return state_->loaded.scene; }

const SceneSettings& Rendering::settings() const { return state_->loaded.settings; }

std::optional<RenderOutcome> RenderObserver::outcome_so_far(std::chrono::milliseconds patience, bool ends) {
    const std::lock_guard lock(so_far_mutex_);
    return so_far_ ? so_far_(patience, ends) : std::nullopt;
}

void RenderObserver::let_ask(SoFar so_far) {
    const std::lock_guard lock(so_far_mutex_);
    so_far_ = std::move(so_far);
}

RenderOutcome render(const RenderRequest& request) { return Rendering(request).run(); }

RenderOutcome render(const RenderRequest& request, RenderObserver& observer) {
    return Rendering(request, observer).run();
}

}  // namespace lampyris

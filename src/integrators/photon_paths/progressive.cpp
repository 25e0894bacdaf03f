#include "integrators/photon_paths/progressive.h"

#include "core/base/error.h"
#include "core/render/sample_slices.h"
#include "integrators/photon_paths/photon_host.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace lampyris {
namespace {

kernel::PhotonPathParams shared_params(const ProgressiveParams& own) {
    kernel::PhotonPathParams shared{};
    shared.maxdepth = own.maxdepth;
    shared.rrdepth = own.rrdepth;
    shared.radius = own.radius;
    shared.footprint = own.footprint;
    shared.minradius = own.minradius;
    shared.alpha = own.alpha;
    shared.schedule = own.schedule;
    shared.direct = own.direct;
    shared.glossy = own.glossy;
    return shared;
}

class ProgressivePhotonMapping {
 public:
    ProgressivePhotonMapping(RenderSession& session, const ProgressiveParams& params, uint32_t eye_samples)
        : session_(session),
          device_(session.device),
          params_(params),
          fixed_(eye_samples > 0),
          // A path that is followed only once takes both branches at a coat.
          branches_(fixed_ && (session.scene.effects.mask() & kernel::EFFECT_LAYERED_COAT) ? 2 : 1),
          points_(std::max(eye_samples, 1u) * branches_),
          pixels_(session.film.pixel_count()),
          eye_slices_(session.device, session.film) {
        const uint64_t points = uint64_t(std::max(eye_samples, 1u)) * branches_ * pixels_;
        if (points > std::numeric_limits<uint32_t>::max())
            throw InputError(fmt::format("error: {} hit points are more than 2^32; use a smaller --spp", points));
        paths_ = params.photonsperiteration > 0 ? uint32_t(params.photonsperiteration)
                                                : session.scene.width() * session.scene.height();
        capacity_ = params.store > 0 ? uint32_t(params.store)
                                     : uint32_t(std::clamp<uint64_t>(4 * uint64_t(paths_), 65536, 1u << 30));
        // Parts are small enough for a key per bounce of each path.
        part_ = std::max(1u, std::min(paths_, std::numeric_limits<uint32_t>::max() / (uint32_t(params.maxdepth) + 1)));
        const uint64_t effects = session.scene.effects.mask();
        window_ = device_.create_buffer(sizeof(kernel::FilmWindow), "film window");
        kernel::PhotonPathParams eye_params = shared_params(params_);
        params_buffer_ = argument_buffer(device_, eye_params, "parameters");
        if (samples_lights_each_pass()) {
            eye_params.direct = kernel::DIRECT_PHOTONS;  // direct light is left to hit_direct_light
            ways_ = device_.create_buffer(points * sizeof(glm::vec4), "radiance on the way to hit points");
        }
        eye_params_buffer_ = argument_buffer(device_, eye_params, "parameters of eye paths");
        pass_buffer_ = device_.create_buffer(sizeof(kernel::PhotonPass), "pass");
        counters_ = device_.create_buffer(sizeof(PhotonCounters), "counters");
        hits_ = device_.create_buffer(points * sizeof(kernel::HitPointRecord), "hit points");
        queries_ = device_.create_buffer(points * sizeof(glm::vec4), "places of hit points");
        gathered_ = device_.create_buffer(points * sizeof(glm::vec4), "gathered flux");
        statistics_ = device_.create_buffer(points * sizeof(glm::vec2), "photon statistics");
        make_store();
        // After the buffers: if some are too large to bind, the device compiles kernels only at their first run, when
        // it knows which.
        eye_ = device_.compile(photon_files::kEye, effects);
        radius_ = device_.compile(photon_files::kRadius, 0);
        photons_ = device_.compile(photon_files::kPhotons, effects);
        resolve_ = device_.compile(photon_files::kResolve, effects);
        if (samples_lights_each_pass()) direct_ = device_.compile(photon_files::kDirect, effects);
        const std::vector<glm::vec2> initial(points, glm::vec2(1.0f, 0.0f));
        statistics_->upload(initial.data(), initial.size() * sizeof(glm::vec2));
        map_ = create_photon_map(session.photon_map);
        map_->open(device_);
        biases_ = device_.create_buffer(points * sizeof(glm::vec4), "bias of gathered flux");
        film_bias_ = device_.create_buffer(size_t(pixels_) * sizeof(kernel::FilmBias), "bias of the film");
        film_bias_->fill_zero();
        // A structure over the hit points passes on only sums, which do not show how flux varies within a disk.
        if (!map_->capabilities().sums_only) session.film.attach_bias(film_bias_, double(params.confidence));
        consumer_ = {photon_files::kConsumer,
                     effects,
                     session.device_scene.get(),
                     {{"hits", hits_}, {"gathered", gathered_}, {"biases", biases_}}};
        map_->prepare(consumer_);
    }

    void render() {
        if (session_.first_pass() > 0 && (fixed_ || params_.schedule == kernel::SCHEDULE_SHARED))
            throw InputError(
                "error: with fixed hit points or schedule=shared, a pass depends on the passes before it and cannot be "
                "rendered alone; use sppm with schedule=memoryless");
        keep_state();
        get_ready();
        while (const uint32_t count = session_.next_passes()) {
            for (uint32_t i = 0; i < count; ++i) one_pass(session_.next_pass() + i);
            session_.passes_finished(count);
        }
        finish();
    }

 private:
    void keep_state() {
        constexpr uint32_t kMostPhotons = 1u << 30;
        const uint32_t capacity = capacity_, most = part_;
        session_.keep_value("paths of a part", part_);
        session_.keep_value("photons of a part", capacity_);
        if (part_ < 1 || part_ > most || capacity_ < capacity || (capacity_ > capacity && capacity_ > kMostPhotons))
            throw InputError("error: the checkpoint cannot be resumed: how it divides passes is out of range");
        if (capacity_ != capacity) make_store();
        session_.keep("photon statistics", statistics_);
        session_.keep("bias of the film", film_bias_);
        if (!fixed_) return;
        session_.keep("hit points", hits_);
        session_.keep("places of hit points", queries_);
        if (ways_) session_.keep("radiance on the way to hit points", ways_);
        session_.keep_value("eye paths were followed", followed_);
    }

    void make_store() {
        store_.reset();
        store_ = device_.create_buffer(size_t(capacity_) * sizeof(kernel::PhotonRecord), "photons");
    }

    // Prepares the kernels, so that the session does not time the compiler.
    void get_ready() {
        run_eye(0);
        run_radius(0);
        run_photons(0);
        run_resolve(0);
        if (direct_) run_direct(0);
    }

    void one_pass(uint64_t pass) {
        ran_ = true;
        pass_.first_path = 0;
        pass_.capacity = capacity_;
        pass_.number = uint32_t(pass);
        pass_.seed = session_.seed;
        pass_.paths = paths_;
        pass_.sampler_kind = session_.sampler;
        pass_.points = points_;
        pass_.part_paths = 0;
        pass_.keep = params_.direct == kernel::DIRECT_PHOTONS ? kernel::KEEP_ALL : kernel::KEEP_BOUNCED;
        pass_.branches = branches_;
        pass_.squared_scale = float(memoryless_scale(pass, double(params_.alpha)));
        const PhotonCounters zero{};
        counters_->upload(&zero, sizeof zero);
        pass_buffer_->upload(&pass_, sizeof pass_);
        if (!fixed_ || !followed_) follow_eye_paths(pass);
        if (samples_lights_each_pass()) sample_lights();
        run_radius(points_ * pixels_);
        const PhotonCounters box = download_counters();
        unpack_box(box, pass_);
        largest_radius_ = std::bit_cast<float>(box[kernel::HIT_LARGEST_RADIUS]);
        // Without a hit point that gathers, no photons are needed.
        if (box[kernel::HIT_LARGEST_RADIUS] > 0) photon_pass();
        resolve(pass);
        if (session_.path_log) session_.path_log->follow_light_paths([&](uint32_t path) { trace_again(path); });
    }

    // One photon path, for the path log: the pass is finished.
    void trace_again(uint32_t path) {
        pass_.first_path = path;
        pass_.part_paths = 1;
        pass_buffer_->upload(&pass_, sizeof pass_);
        run_photons(1);
    }

    void follow_eye_paths(uint64_t pass) {
        eye_slices_.run(fixed_ ? 0u : uint32_t(pass), points_ / branches_, [&](uint32_t first, uint32_t count) {
            set_window(first, count);
            run_eye(pixels_);
        });
        followed_ = true;
    }

    // Direct light at the hit points, which are the same in every pass.
    void sample_lights() {
        // This many points take far fewer iterations than where some drivers end loops: a few dozen per shadow ray. A
        // part is never repeated, because the radiance that the first pass saves must not be saved twice.
        constexpr uint32_t kPoints = 256;
        for (uint32_t done = 0; done < points_; done += kPoints) {
            set_window(done, std::min(points_ - done, kPoints));
            run_direct(pixels_);
        }
    }

    void resolve(uint64_t pass) {
        // The kernel's loop takes one iteration per hit point: far fewer than where some drivers end loops.
        constexpr uint32_t kTurns = 16384;
        const uint32_t samples = points_ / branches_;
        for (uint32_t done = 0; done < samples; done += kTurns) {
            set_window((fixed_ ? 0u : uint32_t(pass)) + done, std::min(samples - done, kTurns));
            run_resolve(pixels_);
        }
    }

    void set_window(uint32_t first, uint32_t count) {
        const kernel::FilmWindow window = session_.window(first, count);
        window_->upload(&window, sizeof window);
    }

    // Emits the pass's paths in parts whose photons fit into the store, and gathers the photons of each.
    void photon_pass() {
        for (uint32_t first = 0; first < paths_;) {
            const uint32_t count = std::min(part_, paths_ - first);
            pass_.first_path = first;
            pass_.capacity = capacity_;
            pass_.part_paths = count;
            pass_buffer_->upload(&pass_, sizeof pass_);
            const uint32_t none[3] = {0, 0, 0};
            counters_->upload(none, sizeof none);
            run_photons(count);
            const PhotonCounters counters = download_counters();
            const uint32_t stored = counters[kernel::PHOTONS_STORED];
            session_.photons.rays += counters[kernel::PHOTON_RAYS];
            // If this part's photons do not fit, or have no unique keys, it is traced again with fewer paths or a
            // larger store.
            if (!keys_reach(count, counters[kernel::PHOTONS_MOST_KEPT])) {
                part_ = std::max(1u, count / 2);
                continue;
            }
            if (stored > capacity_) {
                make_room(count, stored);
                continue;
            }
            session_.photons.emitted += count;
            session_.photons.stored += stored;
            first += count;
            if (stored > 0) gather(stored);
        }
    }

    void make_room(uint32_t count, uint32_t stored) {
        if (count > 1) {
            part_ = std::max(1u, count / 2);
            return;
        }
        capacity_ = stored;
        make_store();
    }

    void gather(uint32_t stored) {
        PhotonSet set;
        set.photons = store_;
        set.count = stored;
        set.queries = queries_;
        set.query_count = points_ * pixels_;
        set.radius = largest_radius_;
        set.low = glm::vec3(pass_.low);
        set.high = glm::vec3(pass_.high);
        set.seed = session_.seed;
        set.pass = pass_.number * 0x9e3779b9u + pass_.first_path;  // each part has its own grid
        set.mean_power = session_.scene.record.light_power / float(paths_);
        if (session_.path_log) session_.path_log->photons_are_of(pass_.first_path, pass_.part_paths);
        map_->build(set);
        map_->gather(consumer_, queries_, 0, points_ * pixels_);
    }

    void run_eye(uint32_t count) {
        run(photon_files::kEye, *eye_, "eye_pass",
            {{"window", window_},
             {"params", eye_params_buffer_},
             {"film", session_.film.buffer()},
             {"hits", hits_},
             {"queries", queries_},
             {"passes", pass_buffer_}},
            count);
    }
    void run_direct(uint32_t count) {
        run(photon_files::kDirect, *direct_, "eye_pass",
            {{"window", window_},
             {"passes", pass_buffer_},
             {"film", session_.film.buffer()},
             {"hits", hits_},
             {"queries", queries_},
             {"ways", ways_}},
            count);
    }
    void run_radius(uint32_t count) {
        run(photon_files::kRadius, *radius_, "eye_pass",
            {{"params", params_buffer_},
             {"passes", pass_buffer_},
             {"hits", hits_},
             {"queries", queries_},
             {"statistics", statistics_},
             {"gathered", gathered_},
             {"counters", counters_},
             {"biases", biases_}},
            count);
    }
    void run_photons(uint32_t count) {
        run(photon_files::kPhotons, *photons_, "photon_tracing",
            {{"passes", pass_buffer_}, {"params", params_buffer_}, {"photons", store_}, {"counters", counters_}},
            count);
    }
    void run_resolve(uint32_t count) {
        run(photon_files::kResolve, *resolve_, "resolve",
            {{"window", window_},
             {"params", params_buffer_},
             {"film", session_.film.buffer()},
             {"passes", pass_buffer_},
             {"hits", hits_},
             {"queries", queries_},
             {"gathered", gathered_},
             {"statistics", statistics_},
             {"biases", biases_},
             {"film_bias", film_bias_}},
            count);
    }
    void run(const char* file, const Kernel& kernel, const char* phase, std::initializer_list<NamedBuffer> buffers,
             uint32_t count) {
        run_in_phase(session_, file, kernel, phase, buffers, count);
    }

    bool samples_lights_each_pass() const { return fixed_ && params_.direct == kernel::DIRECT_NEE; }
    PhotonCounters download_counters() const { return download_photon_counters(*counters_); }

    void finish() {
        if (!ran_) return;  // all passes came from a checkpoint
        add_map_statistics(session_, *map_);
        PhotonStatistics& photons = session_.photons;
        photons.map_parameters = show_photon_map(parse_plugin_choice(session_.photon_map).name, *map_);
        if (const auto load = map_->bucket_load())
            photons.bucket_load_mean = load->mean, photons.bucket_load_max = load->max;
        note_radii(session_, *queries_, *hits_, size_t(points_) * pixels_);
    }

    RenderSession& session_;
    Device& device_;
    const ProgressiveParams params_;
    const bool fixed_;
    const uint32_t branches_;  // hit points per eye path
    const uint32_t points_;    // hit points per pixel
    const uint32_t pixels_;
    uint32_t paths_ = 0, part_ = 0, capacity_ = 0;
    SampleSlices eye_slices_;
    bool followed_ = false, ran_ = false;
    float largest_radius_ = 0;
    kernel::PhotonPass pass_{};
    KernelHandle eye_, direct_, radius_, photons_, resolve_;
    BufferHandle window_, params_buffer_, eye_params_buffer_, pass_buffer_, counters_, hits_, queries_, ways_,
        gathered_, statistics_, biases_, film_bias_, store_;
    std::unique_ptr<PhotonMap> map_;
    PhotonConsumer consumer_;
};

}  // namespace

double memoryless_scale(uint64_t pass, double alpha) {
    // Gamma(pass + 1 + alpha) / (Gamma(pass + 2) Gamma(1 + alpha)): the product in closed form.
    const double n = double(pass);
    return std::exp(std::lgamma(n + 1.0 + alpha) - std::lgamma(n + 2.0) - std::lgamma(1.0 + alpha));
}

void render_progressive(RenderSession& session, const ProgressiveParams& params, uint32_t eye_samples) {
    ProgressivePhotonMapping(session, params, eye_samples).render();
}

}  // namespace lampyris

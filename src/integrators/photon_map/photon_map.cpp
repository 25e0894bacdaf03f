// Photon mapping as Jensen (1996) has it: photons are traced once; passes of eye paths look them up.
#include "core/error.h"
#include "core/integrator.h"
#include "integrators/photon_map/photon_map.params.h"
#include "integrators/sppm/photon_host.h"
#include "integrators/sppm/sppm.params.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace lampyris {
namespace {

// Photons within a radius of 0, if they lay evenly on the scene's bounding sphere.
constexpr double kExpectedPhotons = 50.0;

class PhotonMapRendering {
 public:
    PhotonMapRendering(RenderSession& session, const PhotonMapParams& params)
        : session_(session),
          device_(session.device),
          params_(params),
          pixels_(session.film.pixel_count()),
          paths_(uint32_t(params.photons)) {
        // Keys tell the photons of a path apart.
        const uint64_t keys = uint64_t(paths_) * (uint64_t(params.maxdepth) + 1);
        if (keys > std::numeric_limits<uint32_t>::max())
            throw InputError(
                fmt::format("error: photons * (maxdepth + 1) = {} is more than 2^32; take fewer photons, or a smaller "
                            "maxdepth",
                            keys));
        const uint32_t effects = session.scene.effects.mask();
        eye_ = device_.compile(sppm_files::kEye, effects);
        radius_ = device_.compile(sppm_files::kRadius, 0);
        photons_ = device_.compile(sppm_files::kPhotons, effects);
        resolve_ = device_.compile(sppm_files::kResolve, effects);
        window_ = device_.create_buffer(sizeof(kernel::FilmWindow), "film window");
        pass_buffer_ = device_.create_buffer(sizeof(kernel::SppmPass), "pass");
        counters_ = device_.create_buffer(sizeof(SppmCounters), "counters");
        hits_ = device_.create_buffer(pixels_ * sizeof(kernel::SppmHit), "hit points");
        queries_ = device_.create_buffer(pixels_ * sizeof(glm::vec4), "places of hit points");
        gathered_ = device_.create_buffer(pixels_ * sizeof(glm::vec4), "gathered flux");
        statistics_ = device_.create_buffer(pixels_ * sizeof(glm::vec2), "photon statistics");
        statistics_->fill_zero();  // nothing here reads them
        map_ = create_photon_map(session.photon_map);
        map_->open(device_);
        // What sppm's kernels estimate of a pass's bias is left alone: photons that stay have an error that passes do not show.
        biases_ = device_.create_buffer(pixels_ * sizeof(glm::vec4), "bias of gathered flux");
        film_bias_ = device_.create_buffer(pixels_ * sizeof(kernel::FilmBias), "bias of the film");
        film_bias_->fill_zero();
        consumer_ = {sppm_files::kConsumer, effects, session.device_scene.get(), {hits_, gathered_, biases_}};
        map_->prepare(consumer_);
    }

    void render() {
        trace_photons();
        while (const uint32_t count = session_.next_passes()) {
            for (uint32_t i = 0; i < count; ++i) one_pass(session_.next_pass() + i);
            session_.passes_finished(count);
        }
        finish();
    }

 private:
    // All photons are kept, once: where they are more than there is room for, they are traced again into what they need. A
    // path is a function of its number and the seed, so that they are as many.
    void trace_photons() {
        const glm::vec4 bounds = session_.scene.record.bounds;
        // A little more than the sphere: what lies on it is in the scene.
        const glm::vec3 extent(bounds.w * 1.001f);
        pass_.low = glm::vec4(glm::vec3(bounds) - extent, 0.0f);
        pass_.high = glm::vec4(glm::vec3(bounds) + extent, 0.0f);
        pass_.keep.x =
            params_.direct == kernel::SPPM_DIRECT_PHOTONS ? kernel::SPPM_KEEP_ALL : kernel::SPPM_KEEP_BOUNCED;
        uint64_t capacity = std::min<uint64_t>(std::max<uint64_t>(4 * uint64_t(paths_), 65536), 1u << 30);
        set_parameters(params_.radius);
        for (;;) {
            store_.reset();
            store_ = device_.create_buffer(capacity * sizeof(kernel::PhotonRecord), "photons");
            pass_.photons = {0, uint32_t(capacity), 0, session_.seed};
            pass_.counts = {paths_, session_.sampler, 1, uint32_t(params_.maxdepth) + 1};
            pass_buffer_->upload(&pass_, sizeof pass_);
            counters_->fill_zero();
            run(sppm_files::kPhotons, *photons_, "photon_tracing",
                std::array{pass_buffer_, params_buffer_, store_, counters_}, paths_);
            const SppmCounters counters = download_sppm_counters(*counters_);
            stored_ = counters[kernel::SPPM_STORED];
            session_.photons.rays += counters[kernel::SPPM_RAYS];
            if (stored_ <= capacity) break;
            capacity = stored_;
        }
        session_.photons.emitted = paths_;
        session_.photons.stored = stored_;
        if (!(params_.radius > 0.0f)) {
            // pi r^2 of 4 pi R^2 holds kExpectedPhotons of all.
            const double share = std::min(1.0, kExpectedPhotons / std::max(1.0, double(stored_)));
            set_parameters(float(2.0 * double(bounds.w) * std::sqrt(share)));
        }
    }

    // Those of the kernels, which are sppm's.
    void set_parameters(float radius) {
        sppm_.radius = radius;
        sppm_.maxdepth = params_.maxdepth;
        sppm_.rrdepth = params_.rrdepth;
        sppm_.minradius = params_.minradius;
        sppm_.alpha = 1.0f;
        sppm_.schedule = kernel::SPPM_MEMORYLESS;
        sppm_.direct = params_.direct;
        sppm_.glossy = params_.glossy;
        params_buffer_ = argument_buffer(device_, sppm_, "parameters");
    }

    void one_pass(uint64_t pass) {
        pass_.photons.z = uint32_t(pass);
        pass_.scale.x = 1.0f;
        pass_buffer_->upload(&pass_, sizeof pass_);
        const kernel::FilmWindow window{session_.film.window(), {uint32_t(pass), 1, session_.seed, session_.sampler}};
        window_->upload(&window, sizeof window);
        run(sppm_files::kEye, *eye_, "eye_pass",
            std::array{window_, params_buffer_, session_.film.buffer(), hits_, queries_}, pixels_);
        run(sppm_files::kRadius, *radius_, "eye_pass",
            std::array{params_buffer_, pass_buffer_, hits_, queries_, statistics_, gathered_, counters_, biases_},
            pixels_);
        if (stored_ > 0) {
            if (!built_ || map_->capabilities().needs_queries || !map_->capabilities().exact) build(pass);
            map_->gather(consumer_, queries_, 0, pixels_);
        }
        run(sppm_files::kResolve, *resolve_, "resolve",
            std::array{window_, params_buffer_, session_.film.buffer(), pass_buffer_, hits_, queries_, gathered_,
                       statistics_, biases_, film_bias_},
            pixels_);
    }

    // Once, but for structures over the hit points, which are new, and those that select photons by chance: their noise
    // averages out where the choice is new, too.
    void build(uint64_t pass) {
        PhotonSet set;
        set.photons = store_;
        set.count = stored_;
        set.queries = queries_;
        set.query_count = pixels_;
        set.radius = sppm_.radius;
        set.low = glm::vec3(pass_.low);
        set.high = glm::vec3(pass_.high);
        set.seed = session_.seed;
        set.pass = map_->capabilities().exact ? 0 : uint32_t(pass);
        set.mean_power = std::bit_cast<float>(session_.scene.record.lights.w) / float(paths_);
        map_->build(set);
        built_ = true;
    }

    template <size_t n>
    void run(const char* file, const Kernel& kernel, const char* phase, const std::array<BufferHandle, n>& buffers,
             uint32_t count) {
        run_in_phase(session_, file, kernel, phase, buffers, count);
    }

    void finish() {
        add_map_statistics(session_, *map_);
        PhotonStatistics& photons = session_.photons;
        photons.map_parameters = show_photon_map(parse_plugin_choice(session_.photon_map).name, *map_);
        if (built_) {
            if (const auto load = map_->bucket_load())
                photons.bucket_load_mean = load->mean, photons.bucket_load_max = load->max;
        }
        note_radii(session_, *queries_, *hits_, pixels_);
    }

    RenderSession& session_;
    Device& device_;
    const PhotonMapParams params_;
    const uint32_t pixels_;
    const uint32_t paths_;
    uint32_t stored_ = 0;
    bool built_ = false;
    SppmParams sppm_{};
    kernel::SppmPass pass_{};
    KernelHandle eye_, radius_, photons_, resolve_;
    BufferHandle window_, params_buffer_, pass_buffer_, counters_, hits_, queries_, gathered_, statistics_, biases_,
        film_bias_, store_;
    std::unique_ptr<PhotonMap> map_;
    PhotonConsumer consumer_;
};

class PhotonMapIntegrator : public Integrator {
 public:
    PhotonMapParams params;
    bool uses_photon_map() const override { return true; }
    void render(RenderSession& session) override { PhotonMapRendering(session, params).render(); }
};

REGISTER_INTEGRATOR(PhotonMapIntegrator, PHOTON_MAP_PARAMS, "photon_map",
                    "Photon mapping: photons traced once, which passes of eye paths look up in a radius that stays.")

}  // namespace
}  // namespace lampyris

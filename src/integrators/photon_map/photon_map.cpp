// Photon mapping after Jensen (1996, 2001): photons are traced once; each pass looks them up at the hit points of its
// eye paths, or at the ends of rays from there (final gathering).
#include "core/base/error.h"
#include "core/render/integrator.h"
#include "integrators/photon_map/photon_map_params.h"
#include "integrators/photon_map/stored_photons.h"
#include "integrators/photon_paths/photon_host.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace lampyris {
namespace {

constexpr const char* kNearest = "integrators/photon_map/photon_map_nearest.consumer.h";
constexpr const char* kRays = "integrators/photon_map/photon_map_rays.kernel.h";
constexpr const char* kAdd = "integrators/photon_map/photon_map_add.kernel.h";

// With radius=0: the expected number of photons within the radius, and as a multiple of `nearest`, if photons lay
// evenly on the scene's bounding sphere. The larger one applies.
constexpr double kExpectedPhotons = 50.0, kExpectedOfNearest = 4.0;

// Effects of surfaces that paths follow, so that there may be caustics.
constexpr uint64_t kSpecularEffects =
    kernel::EFFECT_CONDUCTOR | kernel::EFFECT_DIELECTRIC | kernel::EFFECT_THIN_DIELECTRIC | kernel::EFFECT_LAYERED_COAT;

// Points where photons are looked up, one per pixel: hit points of eye paths, or ends of gather rays.
struct Lookups {
    Lookups(Device& device, uint32_t pixels)
        : hits(device.create_buffer(pixels * sizeof(kernel::HitPointRecord), "hit points")),
          queries(device.create_buffer(pixels * sizeof(glm::vec4), "places of hit points")),
          gathered(device.create_buffer(pixels * sizeof(glm::vec4), "gathered flux")) {}
    BufferHandle hits, queries, gathered;
};

class PhotonMapRendering {
 public:
    PhotonMapRendering(RenderSession& session, const PhotonMapParams& params)
        : session_(session),
          device_(session.device),
          params_(params),
          pixels_(session.film.pixel_count()),
          hits_(device_, pixels_) {
        check();
        const uint64_t effects = session.scene.effects.mask();
        eye_ = device_.compile(photon_files::kEye, effects);
        radius_ = device_.compile(photon_files::kRadius, 0);
        resolve_ = device_.compile(photon_files::kResolve, effects);
        window_ = device_.create_buffer(sizeof(kernel::FilmWindow), "film window");
        pass_buffer_ = device_.create_buffer(sizeof(kernel::PhotonPass), "pass");
        counters_ = device_.create_buffer(sizeof(PhotonCounters), "counters");
        own_params_ = argument_buffer(device_, params_, "parameters");
        statistics_ = device_.create_buffer(pixels_ * sizeof(glm::vec2), "photon statistics");
        statistics_->fill_zero();  // sppm's kernels need the buffer, but its values are not used here
        // The pass's bias that sppm's kernels estimate is ignored: the same photons in every pass have an error that
        // passes do not show.
        biases_ = device_.create_buffer(pixels_ * sizeof(glm::vec4), "bias of gathered flux");
        film_bias_ = device_.create_buffer(pixels_ * sizeof(kernel::FilmBias), "bias of the film");
        film_bias_->fill_zero();
        if (params.gather == 0) {
            const uint32_t keep = params.direct == kernel::DIRECT_PHOTONS ? kernel::KEEP_ALL : kernel::KEEP_BOUNCED;
            map_.emplace(session, keep, uint32_t(params.photons), 0, consumer(hits_));
            return;
        }
        rays_ = device_.compile(kRays, effects);
        add_ = device_.compile(kAdd, 0);
        ends_.emplace(device_, pixels_);
        map_.emplace(session, kernel::KEEP_ALL, uint32_t(params.photons), 0, consumer(*ends_));
        if (effects & kSpecularEffects)
            caustics_.emplace(session, kernel::KEEP_CAUSTIC, caustic_paths(), 1, consumer(hits_));
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
    uint32_t caustic_paths() const {
        return uint32_t(params_.causticphotons > 0 ? params_.causticphotons : params_.photons);
    }
    uint32_t gather_rays() const { return uint32_t(params_.gather); }

    void check() const {
        // Keys distinguish the photons of a path: one per bounce, and those at masks, which StoredPhotons counts.
        const uint64_t bounces = uint64_t(params_.maxdepth) + 1;
        const uint64_t keys = std::max(uint32_t(params_.photons), caustic_paths()) * bounces;
        if (keys > std::numeric_limits<uint32_t>::max())
            throw InputError(fmt::format(
                "error: photons * (maxdepth + 1) = {} is more than 2^32; use fewer photons, or a smaller maxdepth",
                keys));
        if (params_.gather > 0 && params_.direct == kernel::DIRECT_PHOTONS)
            throw InputError(
                "error: final gathering (gather above 0) samples lights for direct light; direct=photons needs "
                "gather=0");
        if (params_.nearest > 0 && !finds_nearest(*create_photon_map(session_.photon_map))) {
            std::string others;
            for (const std::string& name : photon_maps().names())
                if (finds_nearest(*create_photon_map(name))) others += (others.empty() ? "" : ", ") + name;
            throw InputError(fmt::format(
                "error: nearest above 0 needs a photon map that passes on every photon in range: {}; \"{}\" does not",
                others, session_.photon_map));
        }
    }
    static bool finds_nearest(const PhotonMap& map) {
        return map.capabilities().exact && !map.capabilities().sums_only;
    }

    PhotonConsumer consumer(const Lookups& lookups) const {
        const bool nearest = params_.nearest > 0;
        const NamedBuffer third = nearest ? NamedBuffer{"photon_map", own_params_} : NamedBuffer{"biases", biases_};
        return {nearest ? kNearest : photon_files::kConsumer,
                session_.scene.effects.mask(),
                session_.device_scene.get(),
                {{"hits", lookups.hits}, {"gathered", lookups.gathered}, third}};
    }

    void trace_photons() {
        set_radii(params_.radius);
        map_->trace(map_params_);
        if (caustics_) caustics_->trace(map_params_);
        if (params_.radius > 0.0f) return;
        // pi r^2 of 4 pi R^2 contains this fraction of all photons.
        const double expected = std::max(kExpectedPhotons, kExpectedOfNearest * params_.nearest);
        const double share = std::min(1.0, expected / std::max(1.0, double(map_->count())));
        set_radii(float(2.0 * double(session_.scene.record.bounds.w) * std::sqrt(share)));
    }

    // Sets the parameters of sppm's kernels, for look-ups at the hit points and in the map.
    void set_radii(float radius) {
        kernel::PhotonPathParams shared{};
        shared.radius = map_radius_ = radius;
        shared.maxdepth = params_.maxdepth;
        shared.rrdepth = params_.rrdepth;
        shared.minradius = params_.minradius;
        shared.alpha = 1.0f;  // radii stay
        shared.schedule = kernel::SCHEDULE_MEMORYLESS;
        shared.direct = params_.direct;
        shared.glossy = params_.glossy;
        map_params_ = argument_buffer(device_, shared, "parameters");
        if (params_.gather > 0 && params_.causticradius > 0.0f) shared.radius = params_.causticradius;
        hit_radius_ = shared.radius;
        hit_params_ = argument_buffer(device_, shared, "parameters");
    }

    void one_pass(uint64_t pass) {
        kernel::PhotonPass record{};
        record.number = uint32_t(pass);
        record.points = 1;
        record.squared_scale = 1.0f;
        record.branches = 1;
        pass_buffer_->upload(&record, sizeof record);
        set_window(uint32_t(pass));
        run(photon_files::kEye, *eye_, "eye_pass",
            {{"window", window_},
             {"params", hit_params_},
             {"film", session_.film.buffer()},
             {"hits", hits_.hits},
             {"queries", hits_.queries},
             {"passes", pass_buffer_}});
        give_radii(hits_, hit_params_, "eye_pass");
        if (params_.gather == 0) {
            map_->gather(hits_.queries, pixels_, hit_radius_, pass);
        } else {
            if (caustics_) caustics_->gather(hits_.queries, pixels_, hit_radius_, pass);
            for (uint32_t ray = 0; ray < gather_rays(); ++ray) one_gather_ray(pass, ray);
        }
        set_window(uint32_t(pass));
        run(photon_files::kResolve, *resolve_, "resolve",
            {{"window", window_},
             {"params", hit_params_},
             {"film", session_.film.buffer()},
             {"passes", pass_buffer_},
             {"hits", hits_.hits},
             {"queries", hits_.queries},
             {"gathered", hits_.gathered},
             {"statistics", statistics_},
             {"biases", biases_},
             {"film_bias", film_bias_}});
    }

    // One ray from every pixel's hit point: there are as many look-ups at once as pixels, for any `gather`.
    void one_gather_ray(uint64_t pass, uint32_t ray) {
        set_window(uint32_t(pass) * gather_rays() + ray);
        run(kRays, *rays_, "final_gather",
            {{"window", window_},
             {"params", map_params_},
             {"film", session_.film.buffer()},
             {"hits", hits_.hits},
             {"places", hits_.queries},
             {"ends", ends_->hits},
             {"queries", ends_->queries}});
        give_radii(*ends_, map_params_, "final_gather");
        map_->gather(ends_->queries, pixels_, map_radius_, pass);
        run(kAdd, *add_, "final_gather",
            {{"params", own_params_},
             {"ends", ends_->hits},
             {"queries", ends_->queries},
             {"gathered", ends_->gathered},
             {"hits", hits_.hits}});
    }

    void set_window(uint32_t sample) {
        const kernel::FilmWindow window = session_.window(sample, 1);
        window_->upload(&window, sizeof window);
    }

    // Also clears the gathered flux.
    void give_radii(const Lookups& lookups, const BufferHandle& parameters, const char* phase) {
        run(photon_files::kRadius, *radius_, phase,
            {{"params", parameters},
             {"passes", pass_buffer_},
             {"hits", lookups.hits},
             {"queries", lookups.queries},
             {"statistics", statistics_},
             {"gathered", lookups.gathered},
             {"counters", counters_},
             {"biases", biases_}});
    }

    void run(const char* file, const Kernel& kernel, const char* phase, std::initializer_list<NamedBuffer> buffers) {
        run_in_phase(session_, file, kernel, phase, buffers, pixels_);
    }

    void finish() {
        map_->finish();
        if (caustics_) caustics_->finish();
        session_.photons.map_parameters = show_photon_map(parse_plugin_choice(session_.photon_map).name, map_->map());
        note_radii(session_, *hits_.queries, *hits_.hits, pixels_);
    }

    RenderSession& session_;
    Device& device_;
    const PhotonMapParams params_;
    const uint32_t pixels_;
    float map_radius_ = 0.0f, hit_radius_ = 0.0f;
    Lookups hits_;
    std::optional<Lookups> ends_;
    KernelHandle eye_, radius_, resolve_, rays_, add_;
    BufferHandle window_, own_params_, map_params_, hit_params_, pass_buffer_, counters_, statistics_, biases_,
        film_bias_;
    std::optional<StoredPhotons> map_, caustics_;
};

class PhotonMapIntegrator : public Integrator {
 public:
    PhotonMapParams params;
    bool uses_photon_map() const override { return true; }
    std::string unseen_error(uint32_t) const override {
        return "all passes use the same photons, whose noise and blur the estimate does not include";
    }
    void render(RenderSession& session) override { PhotonMapRendering(session, params).render(); }
};

REGISTER_INTEGRATOR(
    PhotonMapIntegrator, PHOTON_MAP_PARAMS, "photon_map",
    "Photon mapping: photons are traced once, and looked up by passes of eye paths; k nearest, final gathering.")

}  // namespace
}  // namespace lampyris

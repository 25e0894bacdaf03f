#include "core/render/integrator.h"
#include "integrators/bidirectional/bidirectional_host.h"
#include "integrators/mlt/mlt_host.h"
#include "integrators/mlt/mlt_params.h"
#include "integrators/path/path_params.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace lampyris {
namespace {

constexpr const char* kChains = "integrators/mlt/mlt_chains.kernel.h";
constexpr const char* kPixels = "integrators/mlt/mlt_pixels.kernel.h";

constexpr uint32_t kLeastSeeds = 16384;
// Above this standard error of the brightness of paths, relative to it, pixels may be wrong in ways that their spread does not tell.
constexpr double kUncertainBrightness = 0.05;
// Mutations of a chain in one run of the kernel: few, so that no run is long.
constexpr uint32_t kIterations = 32;

// The first seed of each number of scattering vertices, and the number of all. Paths with n vertices more than the least get a share of
// 1 / (n + 1), since most of the light is in short ones.
std::vector<uint32_t> share_seeds(uint32_t seeds, uint32_t depths) {
    double whole = 0.0;
    for (uint32_t n = 0; n < depths; ++n) whole += 1.0 / (n + 1);
    std::vector<uint32_t> starts{0};
    for (uint32_t n = 0; n < depths; ++n)
        starts.push_back(starts.back() + std::max(1u, uint32_t(seeds / (whole * (n + 1)))));
    return starts;
}

// The seeds at which chains start, in proportion to their weights: `count` equally spaced points, moved by u in [0, 1), of the
// weights laid end to end (systematic resampling).
std::vector<uint32_t> resample(const std::vector<double>& weights, double sum, uint32_t count, double u) {
    std::vector<uint32_t> chosen(count);
    double below = 0.0;
    uint32_t seed = 0, last = 0;
    for (uint32_t i = 0; i < weights.size(); ++i)
        if (weights[i] > 0.0) last = i;
    for (uint32_t i = 0; i < count; ++i) {
        const double point = (i + u) / count * sum;
        // Rounding may leave the last points behind the last seed that is not black.
        while (seed < last && (weights[seed] <= 0.0 || below + weights[seed] <= point)) below += weights[seed++];
        chosen[i] = seed;
    }
    return chosen;
}

// The mean of passes, and its standard error; 0 after a single pass.
struct PassMean {
    double count = 0.0, mean = 0.0, squares = 0.0;
    void add(double x) {
        count += 1.0;
        const double before = x - mean;
        mean += before / count;
        squares += before * (x - mean);
    }
    double error() const { return count > 1.0 ? std::sqrt(squares / (count - 1.0) / count) : 0.0; }
};

// Chains that are long enough to make use of what they find, and enough for a device with many processors.
uint32_t default_chains(uint32_t mutations) { return std::clamp(mutations / 100, 1024u, 65536u); }

class MltRender {
 public:
    MltRender(RenderSession& session, const MltParams& params)
        : session_(session),
          device_(session.device),
          pixels_(session.film.pixel_count()),
          chains_(device_.compile(kChains, session.scene.effects.mask())),
          finish_(device_.compile(kPixels, session.scene.effects.mask())) {
        const double full = double(session.scene.width()) * double(session.scene.height());
        constexpr double kMost = std::numeric_limits<uint32_t>::max() / 2;
        const auto wanted = uint32_t(std::clamp(std::ceil(full * double(params.mutationsperpixel)), 1.0, kMost));
        mlt_.depths = uint32_t(std::max(params.maxdepth - kernel::MLT_LEAST_DEPTH + 1, 0));
        mlt_.chains = std::min(params.chains > 0 ? uint32_t(params.chains) : default_chains(wanted), wanted);
        iterations_ = (wanted + mlt_.chains - 1) / mlt_.chains;
        seeds_ = params.bootstrapsamples >= 0 ? uint32_t(params.bootstrapsamples) : std::max(wanted / 4, kLeastSeeds);
        starts_ = share_seeds(seeds_, mlt_.depths);
        seeds_ = starts_.back();
        mlt_.sigma = params.sigma;
        mlt_.large_step = params.largestepprobability;
        mlt_.quantum = 0x1p-24f;
        mlt_.samples = uint32_t(params.direct);

        // One light path, and one camera ray for all pixels.
        pass_.paths = 1;
        pass_.film_density = film_density(session.scene) / float(full);
        pass_.maxdepth = params.maxdepth;
        pass_.weights = params.weights;
        pass_.connections = -1;
        pass_.samples = 1.0f;
        pass_.only_light = pass_.only_camera = -1;
        passes_->upload(&pass_, sizeof pass_);
        const PathParams direct{std::min(params.maxdepth, kernel::MLT_LEAST_DEPTH - 1), 1};
        params_ = argument_buffer(device_, direct, "parameters of direct light");

        const uint32_t dimensions = kernel::MLT_VERTICES + kernel::MLT_VERTEX_NUMBERS * uint32_t(params.maxdepth);
        splats_ = device_.create_buffer(splat_bytes(pixels_, "mlt"), "splats");
        states_ = device_.create_buffer(size_t(mlt_.chains) * sizeof(kernel::MltState), "chains");
        numbers_ = device_.create_buffer(size_t(mlt_.chains) * dimensions * 4, "numbers of chains");
        luminances_ = device_.create_buffer(std::max<size_t>(seeds_, 1) * 4, "luminances of seeds");
        chosen_ = device_.create_buffer(size_t(mlt_.chains) * 4, "seeds of chains");
        depth_starts_ = device_.create_buffer(starts_.size() * 4, "first seeds of path lengths");
        depth_starts_->upload(starts_.data(), starts_.size() * 4);
        run_chains(0);  // compiles, if need be, before the clock starts
        run_finish(0);
    }

    void render() {
        session_.keep_value("brightness", brightness_);
        if (brightness_.count > 0.0) tell_brightness();
        while (const uint32_t count = session_.next_passes()) {
            for (uint32_t i = 0; i < count; ++i) render_pass(uint32_t(session_.next_pass() + i));
            session_.passes_finished(count);
        }
    }

 private:
    void render_pass(uint32_t number) {
        // Direct light takes its samples as if they were passes.
        const kernel::FilmWindow window = session_.window(number * mlt_.samples, mlt_.samples);
        window_->upload(&window, sizeof window);
        splats_->fill_zero();
        counters_->fill_zero();
        mlt_.seed = session_.seed * 0x9e3779b9u + number * 0x85ebca6bu + 0x27d4eb2fu;
        mlt_.brightness = 0.0f;
        if (mlt_.depths > 0 && session_.scene.record.light_count > 0) run_pass_of_chains();
        mlt_pass_->upload(&mlt_, sizeof mlt_);
        run_finish(pixels_);
    }

    void run_pass_of_chains() {
        set_mode(kernel::MLT_SEEDS, 0, 1);
        run_chains(seeds_);
        std::vector<float> luminances(seeds_);
        luminances_->download(luminances.data(), luminances.size() * 4);
        // The sum of weights is the picture's brightness: the mean luminance of paths with each number of vertices, summed.
        std::vector<double> weights(seeds_);
        double sum = 0.0;
        for (uint32_t n = 0; n < mlt_.depths; ++n)
            for (uint32_t i = starts_[n]; i < starts_[n + 1]; ++i)
                sum += weights[i] = double(luminances[i]) / (starts_[n + 1] - starts_[n]);
        if (sum > 0.0) {
            const double u = double(hash_of(mlt_.seed)) * 0x1p-32;
            const std::vector<uint32_t> chosen = resample(weights, sum, mlt_.chains, u);
            chosen_->upload(chosen.data(), chosen.size() * 4);
            set_mode(kernel::MLT_START, 0, 1);
            run_chains(mlt_.chains);
            for (uint32_t done = 0; done < iterations_; done += kIterations) {
                set_mode(kernel::MLT_MUTATE, done, std::min(iterations_ - done, kIterations));
                run_chains(mlt_.chains);
            }
        }
        mlt_.brightness = float(sum / (double(mlt_.chains) * double(iterations_)));
        std::array<uint32_t, kernel::MLT_COUNTERS> counters{};
        counters_->download(&counters, sizeof counters);
        session_.photons.rays += counters[kernel::MLT_RAYS];
        const double mutations = double(mlt_.chains) * double(iterations_), large = counters[kernel::MLT_LARGE_STEPS];
        session_.add_count("bootstrap_samples", seeds_);
        session_.add_count("large_steps", large);
        session_.add_count("large_steps_accepted", counters[kernel::MLT_LARGE_ACCEPTED]);
        session_.add_count("small_steps", sum > 0.0 ? mutations - large : 0.0);
        session_.add_count("small_steps_accepted", counters[kernel::MLT_SMALL_ACCEPTED]);
        brightness_.add(sum / (double(session_.scene.width()) * double(session_.scene.height())));
        tell_brightness();
    }

    void tell_brightness() {
        session_.set_count("brightness", brightness_.mean);
        session_.set_count("brightness_error", brightness_.error());
        const double uncertain = brightness_.mean > 0.0 ? brightness_.error() / brightness_.mean : 0.0;
        session_.unseen_error =
            uncertain > kUncertainBrightness
                ? fmt::format(
                      "the brightness of longer paths differs between passes, by {:.0f} % of its mean: chains have "
                      "not found all that is bright",
                      100.0 * uncertain)
                : std::string();
    }

    static uint32_t hash_of(uint32_t x) {
        x ^= x >> 16;
        x *= 0x7feb352du;
        x ^= x >> 15;
        x *= 0x846ca68bu;
        return x ^ (x >> 16);
    }

    void set_mode(uint32_t mode, uint32_t first, uint32_t iterations) {
        mlt_.mode = mode;
        mlt_.first = first;
        mlt_.iterations = iterations;
        mlt_pass_->upload(&mlt_, sizeof mlt_);
    }

    void run_chains(uint32_t count) {
        const std::array<NamedBuffer, 10> buffers{{{"window", window_},
                                                   {"passes", passes_},
                                                   {"mlt", mlt_pass_},
                                                   {"splats", splats_},
                                                   {"counters", counters_},
                                                   {"states", states_},
                                                   {"numbers", numbers_},
                                                   {"luminances", luminances_},
                                                   {"chosen", chosen_},
                                                   {"depth_starts", depth_starts_}}};
        device_.run(*chains_, session_.device_scene.get(), buffers, 0, count);
    }

    void run_finish(uint32_t count) {
        const std::array<NamedBuffer, 5> buffers{{{"window", window_},
                                                  {"params", params_},
                                                  {"film", session_.film.buffer()},
                                                  {"mlt", mlt_pass_},
                                                  {"splats", splats_}}};
        device_.run(*finish_, session_.device_scene.get(), buffers, 0, count);
    }

    RenderSession& session_;
    Device& device_;
    const uint32_t pixels_;
    kernel::BidirectionalPass pass_{};
    kernel::MltPass mlt_{};
    uint32_t iterations_ = 0, seeds_ = 0;
    std::vector<uint32_t> starts_;  // first seed of each number of scattering vertices, and the number of all
    PassMean brightness_;           // mean luminance of the picture, of paths with MLT_LEAST_DEPTH vertices or more
    KernelHandle chains_, finish_;
    BufferHandle window_ = device_.create_buffer(sizeof(kernel::FilmWindow), "film window");
    BufferHandle passes_ = device_.create_buffer(sizeof(kernel::BidirectionalPass), "pass");
    BufferHandle mlt_pass_ = device_.create_buffer(sizeof(kernel::MltPass), "pass of chains");
    BufferHandle counters_ = device_.create_buffer(kernel::MLT_COUNTERS * 4, "counters");
    BufferHandle params_, splats_, states_, numbers_, luminances_, chosen_, depth_starts_;
};

class Mlt : public Integrator {
 public:
    MltParams params;

    void render(RenderSession& session) override { MltRender(session, params).render(); }
};

REGISTER_INTEGRATOR(Mlt, MLT_PARAMS, "mlt",
                    "Metropolis light transport: chains of mutated paths, in primary sample space, multiplexed.")

}  // namespace
}  // namespace lampyris

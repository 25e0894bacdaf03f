#include "integrators/bidirectional/pilot.h"

#include "core/base/error.h"
#include "core/render/film.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace lampyris {
namespace {

constexpr uint32_t kPasses = 8;                                      // of each of two seeds
constexpr uint32_t kPixelShare = 256;                                // of the picture's pixels to the pilot's
constexpr uint32_t kFewestPixels = 256, kMostPixels = 1024;          // of the pilot
constexpr std::array<uint32_t, 2> kSeeds{0x85ebca6bu, 0xc2b2ae35u};  // separate its random numbers from the rendering's
constexpr uint32_t kBlock = 4;        // side, in pixels, of blocks whose shares of strategies are estimated
constexpr double kLeastShare = 1e-4;  // of strategies: below, the pilot knows nothing of it
constexpr double kWorstShare = 1e-3;  // of pixels, whose errors count as the largest of the others
// Added to the variance relative to the squared radiance: where nothing is noisy, the cheapest will do.
constexpr double kLeastNoise = 1e-6;
// The error times the cost of fewer strategies must be below this times that of all: they fail on light that the pilot does not see.
constexpr double kGain = 0.9;
constexpr double kSignificant = 2.0;  // standard errors by which it must be below

// Light paths of the pilot's passes for each pixel. With more, less noise costs as much more, and the pilot may take minutes.
constexpr double kMostPaths = 4.0;

// In units of a ray.
constexpr double kPathCost = 0.75;   // of path tracing, whose kernel computes no weights of other strategies
constexpr double kPairCost = 0.5;    // of a pair of vertices that may be connected, before its shadow ray
constexpr double kVertexCost = 0.5;  // of a light path's vertex: its record
constexpr double kPhotonCost = 0.5;  // of a photon
constexpr double kQueryCost = 1.0;   // of a camera path's vertex that is merged

std::string name_of(const BidirectionalOptions& options) {
    if (!options.light_paths) return "no light paths";
    const bool connects = options.connections != 0, merges = options.radius >= 0.0;
    if (connects && merges) return "connections and merging";
    return connects ? "connections" : merges ? "merging" : "splats";
}

// From all strategies to the fewest.
std::vector<BidirectionalOptions> candidates(const BidirectionalOptions& all) {
    const bool any_connections = all.connections < 0;
    const bool merges = all.radius >= 0.0;
    std::vector<BidirectionalOptions> result{all};
    const auto add = [&](int connections, double radius, bool light_paths) {
        BidirectionalOptions options = all;
        options.connections = connections;
        options.radius = radius;
        options.light_paths = light_paths;
        result.push_back(options);
    };
    constexpr double kNoMerging = -1.0;
    if (merges && any_connections) add(0, all.radius, true);
    if (merges) add(all.connections, kNoMerging, true);
    if (any_connections) add(0, kNoMerging, true);
    if (all.lightpaths <= 0) add(0, kNoMerging, false);
    return result;
}

// The scene's picture at a resolution that makes about as many pixels as the pilot has.
kernel::CameraRecord pilot_camera(kernel::CameraRecord camera) {
    const double width = camera.resolution_x, height = camera.resolution_y, pixels = width * height;
    const double wanted = std::clamp(pixels / kPixelShare, double(kFewestPixels), double(kMostPixels));
    const double scale = std::min(1.0, std::sqrt(wanted / pixels));
    camera.resolution_x = uint32_t(std::max(1.0, std::round(width * scale)));
    camera.resolution_y = uint32_t(std::max(1.0, std::round(height * scale)));
    camera.screen.z *= float(width / camera.resolution_x);
    camera.screen.w *= float(height / camera.resolution_y);
    camera.crop_x = camera.crop_y = 0;
    return camera;
}

double mean_of(glm::dvec3 v) { return (v.x + v.y + v.z) / 3.0; }

// During its lifetime, the device's scene has another camera.
class OtherCamera {
 public:
    OtherCamera(DeviceScene& scene, const kernel::CameraRecord& other, const kernel::CameraRecord& own)
        : scene_(scene), own_(own) {
        scene_.set_camera(other);
    }
    ~OtherCamera() { scene_.set_camera(own_); }
    OtherCamera(const OtherCamera&) = delete;
    OtherCamera& operator=(const OtherCamera&) = delete;

 private:
    DeviceScene& scene_;
    const kernel::CameraRecord own_;
};

// During its lifetime, nothing is logged: a replay's log has the paths of the rendering.
class NoLog {
 public:
    explicit NoLog(PathLogger* log) : log_(log) {
        if (log_) log_->stop();
    }
    ~NoLog() {
        if (log_) log_->go_on();
    }
    NoLog(const NoLog&) = delete;
    NoLog& operator=(const NoLog&) = delete;

 private:
    PathLogger* log_;
};

// A candidate's image: of each pixel, the mean and the variance of one pass.
struct Pilot {
    uint32_t width = 0, height = 0;
    std::vector<glm::dvec3> mean, variance;
    std::vector<glm::vec4> shares;  // BidirectionalOptions::shares
    double cost = 0.0;              // of a pass and pixel, in rays
    double rays = 0.0, seconds = 0.0;

    uint32_t block_columns() const { return (width + kBlock - 1) / kBlock; }
    size_t blocks() const { return size_t(block_columns()) * ((height + kBlock - 1) / kBlock); }
    size_t block_of(size_t pixel) const { return pixel / width / kBlock * block_columns() + pixel % width / kBlock; }
    // The mean of 3 x 3 pixels.
    glm::dvec3 smooth(uint32_t x, uint32_t y) const {
        glm::dvec3 sum(0.0);
        double count = 0.0;
        for (uint32_t j = y > 0 ? y - 1 : 0; j < std::min(height, y + 2); ++j)
            for (uint32_t i = x > 0 ? x - 1 : 0; i < std::min(width, x + 2); ++i)
                sum += mean[size_t(j) * width + i], count += 1.0;
        return sum / count;
    }
};

// Counted, not measured, so that the choice is the same each time.
double cost_of(const RenderSession& session, double rays) {
    const auto count = [&](const char* name) {
        const auto found = session.counts().find(name);
        return found == session.counts().end() ? 0.0 : found->second;
    };
    const double light_vertices = count("light_vertices"), paths = std::max(1.0, count("light_paths"));
    // About half of the rays from the camera's side go from vertex to vertex, the others to lights.
    const double camera_vertices =
        0.5 * std::max(0.0, rays - double(session.photons.rays) - count("connections_tried"));
    return rays + kPairCost * camera_vertices * light_vertices / paths + kVertexCost * light_vertices +
           kPhotonCost * double(session.photons.stored) + kQueryCost * count("camera_vertices_merged");
}

// The mean of kPasses passes of a seed, three numbers for each pixel; shares and costs are added to the pilot's. Empty if it was
// interrupted.
std::vector<float> render_passes(const RenderSession& session, const Scene& scene, BidirectionalOptions options,
                                 uint32_t seed, Pilot& pilot) {
    Film film(session.device, scene, {0, 0, int(scene.width()), int(scene.height())});
    BudgetLimits limits;
    limits.passes = kPasses;
    RenderSession own(session.device, scene, session.device_scene, film, limits);
    own.seed = seed;
    own.sampler = session.sampler;
    own.photon_map = session.photon_map;
    std::vector<glm::vec4> shares;
    options.shares = &shares;
    render_bidirectional(own, options);
    if (own.progress().passes < kPasses) return {};
    for (size_t i = 0; i < shares.size(); ++i) pilot.shares[i] += shares[i];
    const double rays = double(own.progress().rays + own.photons.rays);
    pilot.rays += rays;
    pilot.seconds += own.progress().wall_s;
    const double cost = options.light_paths ? cost_of(own, rays) : kPathCost * rays;
    pilot.cost += cost / (2.0 * double(kPasses) * film.pixel_count());
    std::vector<float> rgb = film.rgb();
    for (float& value : rgb)
        if (!std::isfinite(value)) value = 0.0f;
    return rgb;
}

// Of two seeds, because passes of one are stratified: their differences show how fast the error really falls. Empty if it was
// interrupted.
std::optional<Pilot> render_pilot(const RenderSession& session, const Scene& scene,
                                  const BidirectionalOptions& options) {
    Pilot pilot;
    pilot.width = scene.width(), pilot.height = scene.height();
    pilot.shares.resize(size_t(pilot.width) * pilot.height, glm::vec4(0.0f));
    const std::vector<float> first = render_passes(session, scene, options, session.seed ^ kSeeds[0], pilot);
    const std::vector<float> second = render_passes(session, scene, options, session.seed ^ kSeeds[1], pilot);
    if (first.empty() || second.empty()) return {};
    for (size_t i = 0; i < first.size(); i += 3) {
        const glm::dvec3 a(first[i], first[i + 1], first[i + 2]), b(second[i], second[i + 1], second[i + 2]);
        pilot.mean.push_back(0.5 * (a + b));
        pilot.variance.push_back(0.5 * double(kPasses) * (a - b) * (a - b));
    }
    return pilot;
}

// One over the squared radiance of each pixel, which errors are relative to. The median over the candidates, because some miss light,
// and others have fireflies.
std::vector<double> relative_to(const std::vector<Pilot>& pilots) {
    const Pilot& first = pilots.front();
    std::vector<double> radiance;
    double mean = 0.0;
    for (uint32_t y = 0; y < first.height; ++y)
        for (uint32_t x = 0; x < first.width; ++x) {
            std::vector<double> values;
            for (const Pilot& pilot : pilots) values.push_back(mean_of(pilot.smooth(x, y)));
            const auto middle = values.begin() + long(values.size() / 2);
            std::nth_element(values.begin(), middle, values.end());
            radiance.push_back(*middle);
            mean += *middle / double(first.mean.size());
        }
    for (double& value : radiance) value = 1.0 / std::max(value * value + 0.01 * mean * mean, 1e-60);
    return radiance;
}

// Of each block of pixels, the sum of the variances of one pass relative to the squared radiance.
std::vector<double> noise_of_blocks(const Pilot& pilot, const std::vector<double>& relative) {
    std::vector<double> errors(relative.size());
    for (size_t i = 0; i < errors.size(); ++i) errors[i] = mean_of(pilot.variance[i]) * relative[i];
    std::vector<double> sorted = errors;
    std::sort(sorted.begin(), sorted.end());
    const double most = sorted[sorted.size() - 1 - size_t(kWorstShare * double(sorted.size()))];
    std::vector<double> blocks(pilot.blocks());
    for (size_t i = 0; i < errors.size(); ++i) blocks[pilot.block_of(i)] += std::min(errors[i], most);
    return blocks;
}

// Of each block, the share of the radiance that is contributed by the candidate's strategies, when all are there.
std::vector<double> kept_shares(const Pilot& all, const BidirectionalOptions& candidate) {
    const glm::dvec4 kept(1.0, candidate.connections != 0, candidate.light_paths, candidate.radius >= 0.0);
    std::vector<double> part(all.blocks()), whole(all.blocks());
    for (size_t i = 0; i < all.shares.size(); ++i) {
        const glm::dvec4 found(all.shares[i]);
        part[all.block_of(i)] += glm::dot(found, kept);
        whole[all.block_of(i)] += glm::dot(found, glm::dvec4(1.0));
    }
    for (size_t i = 0; i < part.size(); ++i)
        part[i] = whole[i] > 0.0 ? std::clamp(part[i] / whole[i], kLeastShare, 1.0) : 1.0;
    return part;
}

// Of each block, the variance of one pass times its cost. A variance that was not measured, because the pilot has no path that carries
// the light, is estimated: of a path that weights give to the candidate's strategies to the share w, their second moment is 1 / w of that
// of all (Grittmann and others 2022), in the mean about 1 over the mean of w.
std::vector<double> scores_of(const Pilot& pilot, const Pilot& all, const BidirectionalOptions& candidate,
                              const std::vector<double>& relative) {
    std::vector<double> scores = noise_of_blocks(pilot, relative);
    const std::vector<double> of_all = noise_of_blocks(all, relative), kept = kept_shares(all, candidate);
    for (size_t i = 0; i < scores.size(); ++i)
        scores[i] = (std::max(scores[i], of_all[i] / kept[i]) + kLeastNoise) * pilot.cost;
    return scores;
}

// A candidate's score over that of all strategies.
struct Quotient {
    double value = 1.0, error = 0.0;  // standard error, by the spread of blocks
};

Quotient quotient(const std::vector<double>& scores, const std::vector<double>& of_all) {
    double sum = 0.0, sum_of_all = 0.0, squares = 0.0;
    for (size_t i = 0; i < scores.size(); ++i) sum += scores[i], sum_of_all += of_all[i];
    Quotient q;
    q.value = sum / sum_of_all;
    for (size_t i = 0; i < scores.size(); ++i) {
        const double rest = scores[i] - q.value * of_all[i];
        squares += rest * rest;
    }
    q.error = std::sqrt(squares) / sum_of_all;
    return q;
}

}  // namespace

BidirectionalOptions choose_counts(RenderSession& session, const BidirectionalOptions& options) {
    // Without its arrays: what host code asks for while it renders.
    Scene scene;
    scene.record = session.scene.record;
    scene.record.camera = pilot_camera(session.scene.record.camera);
    scene.effects = session.scene.effects;
    const NoLog none(session.path_log);
    const OtherCamera other(*session.device_scene, scene.record.camera, session.scene.record.camera);
    const double full_pixels = double(session.scene.width()) * session.scene.height();
    const double pixels = double(scene.width()) * scene.height(), share = pixels / full_pixels;

    const std::vector<BidirectionalOptions> list = candidates(options);
    if (list.size() == 1)
        throw InputError(fmt::format(
            "error: counts=auto leaves \"{}\" nothing to choose if lightpaths={} and connections={} are given: "
            "leave one of them at -1, or counts at fixed",
            options.name, options.lightpaths, options.connections));
    std::vector<Pilot> pilots;
    double seconds = 0.0, rays = 0.0;
    for (BidirectionalOptions small : list) {
        if (small.lightpaths > 0)
            small.lightpaths = int(std::clamp(std::round(small.lightpaths * share), 1.0, kMostPaths * pixels));
        std::optional<Pilot> pilot = render_pilot(session, scene, small);
        if (!pilot) return options;
        seconds += pilot->seconds;
        rays += pilot->rays;
        pilots.push_back(std::move(*pilot));
    }
    const std::vector<double> relative = relative_to(pilots);
    const std::vector<double> of_all = scores_of(pilots[0], pilots[0], list[0], relative);
    size_t best = 0;
    double least = kGain;
    for (size_t i = 1; i < pilots.size(); ++i) {
        const Quotient q = quotient(scores_of(pilots[i], pilots[0], list[i], relative), of_all);
        if (q.value < least && q.value + kSignificant * q.error < 1.0) best = i, least = q.value;
    }
    const BidirectionalOptions& chosen = list[best];
    session.add_preparation(seconds);
    session.add_phase("pilot", seconds);
    session.add_count("pilot_rays", rays);
    session.add_choice("strategies", name_of(chosen));
    session.add_choice("light_paths", std::to_string(chosen.light_paths ? light_path_count(chosen, session.scene) : 0));
    session.add_choice("connections", std::to_string(chosen.connections));
    if (options.radius >= 0.0) session.add_choice("merging", chosen.radius >= 0.0 ? "true" : "false");
    if (session.on_note)
        session.on_note(best == 0 ? fmt::format("counts=auto: all strategies ({})", name_of(list[0]))
                                  : fmt::format("counts=auto: {}: error times cost is {:.2g} of that of all strategies",
                                                name_of(chosen), least));
    return chosen;
}

}  // namespace lampyris

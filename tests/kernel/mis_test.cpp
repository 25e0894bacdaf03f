// The recursion for the weights of bidirectional paths (integrators/bidirectional/mis.h) against the definition: the densities
// of all strategies, as products along the path, in double precision.
#include "support/device_run.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace lampyris::test {
namespace {

using glm::dvec3;
using glm::vec3;
using glm::vec4;

constexpr uint32_t kArea = 0, kPassed = 1, kInfinite = 2, kPoint = 3, kDistant = 4;
constexpr uint32_t kStrategies = 8, kWeights = 2 * kStrategies;  // of connections, then of merging
constexpr uint32_t kPaths = 4000;

// A cosine is off by about 1e-7, so the least one here by 5e-6 of itself. The power heuristic doubles that, and a quarter of
// it reaches the weight, whose derivative is w (1 - w). A path has up to 14 cosines: at worst 4e-5, and some 100 roundings of
// 2^-24 add 6e-6. The largest deviation is 1e-6.
constexpr double kTolerance = 1e-4;
constexpr double kLeastCosine = 0.02;

// As in mis_probe.kernel.h.
struct ProbeVertex {
    vec4 position, normal;
    float to_camera, to_light, eta;
    uint32_t specular;
};
struct ProbePath {
    uint32_t first, count, light, orthographic;
    float pe, pw, pd, sides;
    float pc, lens_samples, radius, samples, eta;
};

struct Paths {
    std::vector<ProbePath> paths;
    std::vector<ProbeVertex> vertices;
};

// What a wrong implementation might do.
enum class Mistake {
    kNone,
    kShadingCosine,
    kNoEta,
    kOrthographicDistance,
    kNoLensSamples,
    kAreaDensityOfLight,
    kOneConnection,
    kFewMerged
};

// One path, and the densities with which its vertices are sampled from their neighbours.
class Reference {
 public:
    Reference(const Paths& all, size_t index, Mistake mistake = Mistake::kNone)
        : path_(all.paths[index]), vertices_(&all.vertices[path_.first]), mistake_(mistake) {}

    // The density of strategy s, up to a factor that all share: the first s vertices come from the light, the others from the
    // camera. 0 if it is impossible.
    double density(uint32_t s) const {
        const uint32_t last = path_.count - 1;
        if (s == 0 && path_.light != kArea && path_.light != kInfinite) return 0;
        if (s > 0 && (is_specular(s - 1) || is_specular(s))) return 0;
        double product = s == last ? double(path_.lens_samples) : 1.0;
        if (s == last && mistake_ == Mistake::kNoLensSamples) product = 1;
        if (s > 1 && s < last && mistake_ != Mistake::kOneConnection) product *= double(path_.samples);
        for (uint32_t i = 0; i < s; ++i) product *= s == 1 ? next_event() : from_light(i);
        for (uint32_t i = s; i < last; ++i) product *= from_camera(i);
        return product;
    }

    // The same of merging at vertex i: both ends sample it, and a light path's vertex counts if it is within the radius.
    double merging(uint32_t i) const {
        if (i == 0 || i + 1 >= path_.count || is_specular(i)) return 0;
        double product = double(path_.eta) * path_.radius * path_.radius;
        if (mistake_ == Mistake::kFewMerged) product /= 10;
        for (uint32_t k = 0; k <= i; ++k) product *= from_light(k);
        for (uint32_t k = i; k + 1 < path_.count; ++k) product *= from_camera(k);
        return product;
    }

    std::vector<double> weights(int beta) const {
        std::vector<double> terms(kWeights, -1);
        double sum = 0;
        for (uint32_t s = 0; s < path_.count; ++s) {
            if (density(s) > 0) sum += terms[s] = std::pow(density(s), beta);
            if (merging(s) > 0) sum += terms[kStrategies + s] = std::pow(merging(s), beta);
        }
        for (double& term : terms)
            if (term >= 0) term /= sum;
        return terms;
    }

    double cosine(uint32_t at, uint32_t other) const {
        dvec3 n(vertices_[at].normal);
        if (mistake_ == Mistake::kShadingCosine) n = glm::normalize(n + 0.3 * dvec3(n.y, n.z, n.x));
        return std::abs(glm::dot(n, glm::normalize(way(at, other))));
    }

 private:
    bool is_specular(uint32_t i) const { return vertices_[i].specular != 0; }
    bool at_infinity() const { return path_.light == kInfinite || path_.light == kDistant; }
    dvec3 way(uint32_t from, uint32_t to) const {
        return dvec3(vertices_[to].position) - dvec3(vertices_[from].position);
    }
    // From a density of directions at `from` to one of positions at `to`.
    double per_area(uint32_t from, uint32_t to) const {
        return cosine(to, from) / glm::dot(way(from, to), way(from, to));
    }

    // Of vertex i, given the one before it on the light's path.
    double from_light(uint32_t i) const {
        if (i == 0) return path_.pe;
        if (i > 1) return scattered(i - 1, i);
        if (at_infinity()) return path_.pw * cosine(1, 0);
        const double direction =
            path_.light == kPoint ? double(path_.pw) : cosine(0, 1) / (std::numbers::pi * path_.sides);
        return direction * per_area(0, 1);
    }
    // Of vertex i, given the one before it on the camera's path.
    double from_camera(uint32_t i) const {
        const uint32_t camera = path_.count - 1;
        if (i + 1 < camera) return scattered(i + 1, i);
        const bool distance = path_.orthographic == 0 || mistake_ == Mistake::kOrthographicDistance;
        return path_.pc * (distance ? per_area(camera, i) : cosine(i, camera));
    }
    // The same of the light's vertex, when vertex 1 samples it on purpose.
    double next_event() const {
        if (path_.light > kPassed) return path_.pe;
        return mistake_ == Mistake::kAreaDensityOfLight ? double(path_.pe) : path_.pd * per_area(1, 0);
    }
    // Sampling of the direction from one vertex to a neighbour. A specular density is a delta function of the solid angle. The
    // strategies that have it on the light's path and those that have it on the camera's differ by the change of
    // variables: eta^2 cos dw is the same on both sides of a refraction.
    double scattered(uint32_t from, uint32_t to) const {
        const ProbeVertex& v = vertices_[from];
        double density = to > from ? v.to_camera : v.to_light;
        if (is_specular(from)) {
            density *= cosine(from, to);
            if (to > from && mistake_ != Mistake::kNoEta) density *= double(v.eta) * v.eta;
        }
        return to == 0 && at_infinity() ? density : density * per_area(from, to);
    }

    const ProbePath& path_;
    const ProbeVertex* vertices_;
    Mistake mistake_;
};

class Maker {
 public:
    Maker(uint32_t seed, float density_spread, double least_cosine, float least_distance)
        : random_(seed),
          density_spread_(density_spread),
          least_cosine_(least_cosine),
          least_distance_(least_distance) {}

    // Appends a path that at least one strategy can sample.
    void append(Paths& all) {
        for (;;) {
            Paths one;
            make(one);
            const Reference path(one, 0);
            bool possible = false;
            for (uint32_t s = 0; s < one.paths[0].count; ++s) possible = possible || path.density(s) > 0;
            if (!possible) continue;
            one.paths[0].first = uint32_t(all.vertices.size());
            all.paths.push_back(one.paths[0]);
            all.vertices.insert(all.vertices.end(), one.vertices.begin(), one.vertices.end());
            return;
        }
    }

 private:
    void make(Paths& one) {
        ProbePath p{};
        p.count = 3 + random_() % 6;
        p.light = random_() % 5;
        p.orthographic = random_() % 3 == 0;
        p.radius = spread(3);
        const float per_area = 1 / (p.radius * p.radius);
        p.sides = random_() % 2 ? 2.0f : 1.0f;
        p.pe = spread(1) * (p.light <= kPassed ? per_area : 1.0f);
        p.pw = spread(1) * (p.light == kPoint ? 1.0f : per_area);
        p.pd = p.light <= kPassed ? spread(1) : p.pe;
        // A pixel has a small solid angle, and many light paths.
        const float pixels = std::pow(10.0f, float(random_() % 7));
        p.lens_samples = pixels * spread(1);
        p.samples = float(1 + random_() % 4);
        p.pc = pixels * spread(1) * (p.orthographic ? per_area : 1.0f);
        p.eta = random_() % 2 ? spread(2) : 0.0f;
        one.paths = {p};
        for (uint32_t i = 0; i < p.count; ++i) {
            one.vertices.push_back(vertex(i));
            vec4& position = one.vertices[i].position;
            do position = p.radius * vec4(normal(), normal(), normal(), 0);
            while (i > 0 && glm::distance(position, one.vertices[i - 1].position) < least_distance_ * p.radius);
        }
        one.vertices.back().specular = 0;
        const Reference path(one, 0);
        for (uint32_t i = 0; i < p.count; ++i) {
            double least;
            do {
                one.vertices[i].normal = vec4(glm::normalize(dvec3(normal(), normal(), normal())), 0);
                least = i > 0 ? path.cosine(i, i - 1) : 1;
                if (i + 1 < p.count) least = std::min(least, path.cosine(i, i + 1));
            } while (least < least_cosine_);
        }
    }
    ProbeVertex vertex(uint32_t i) {
        ProbeVertex v{};
        v.to_camera = spread(density_spread_);
        v.to_light = spread(density_spread_);
        v.eta = 1;
        if (i == 0 || random_() % 20 >= 7) return v;
        v.specular = 1;
        v.to_camera = v.to_light =
            0.2f + 0.8f * std::uniform_real_distribution<float>()(random_);  // of choosing the lobe
        if (random_() % 2) v.eta = spread(0.6f);
        return v;
    }
    float normal() { return normal_(random_); }
    float spread(float deviation) { return std::exp(deviation * normal()); }

    std::mt19937 random_;
    std::normal_distribution<float> normal_;
    float density_spread_;
    double least_cosine_;
    float least_distance_;
};

Paths paths_of(Maker maker) {
    Paths all;
    for (uint32_t i = 0; i < kPaths; ++i) maker.append(all);
    return all;
}

const Paths& random_paths() {
    static const Paths paths = paths_of(Maker(1, 1, kLeastCosine, 0.1f));
    return paths;
}

// kWeights weights of each path; -1 of those that are impossible.
std::vector<float> weights_on(const std::string& backend, const Paths& all, int beta) {
    const auto device = create_device(backend, exact_options(backend));
    const auto kernel = device->compile("kernel/mis_probe.kernel.h", 0);
    const size_t count = all.paths.size();
    const BufferHandle out = device->create_buffer(kWeights * count * sizeof(float), "weights");
    const std::vector what{glm::uvec4(beta - 1, 0, 0, 0)};
    const NamedBuffer buffers[] = {{"what", upload(*device, what, "what")},
                                   {"paths", upload(*device, all.paths, "paths")},
                                   {"vertices", upload(*device, all.vertices, "vertices")},
                                   {"weights", out}};
    device->run(*kernel, nullptr, buffers, 0, uint32_t(count));
    return download<float>(out, kWeights * count);
}

TEST(Mis, RecursionGivesTheWeightsOfAllStrategies) {
    for (const std::string& backend : kernel_backends()) {
        for (int beta = 1; beta <= 2; ++beta) {
            SCOPED_TRACE(backend + ", beta " + std::to_string(beta));
            const std::vector<float> found = weights_on(backend, random_paths(), beta);
            for (uint32_t i = 0; i < kPaths; ++i) {
                const std::vector<double> right = Reference(random_paths(), i).weights(beta);
                double sum = 0;
                for (uint32_t s = 0; s < kWeights; ++s) {
                    const double weight = found[kWeights * i + s];
                    ASSERT_EQ(weight < 0, right[s] < 0) << "path " << i << ", strategy " << s;
                    ASSERT_NEAR(weight, right[s], kTolerance) << "path " << i << ", strategy " << s;
                    if (weight > 0) sum += weight;
                }
                ASSERT_NEAR(sum, 1, kTolerance) << "path " << i;
            }
        }
    }
}

// Weights below the normal floats count as 0 (docs/kernel-dialect.md).
TEST(Mis, BackendsAgreeToTheBit) {
    const auto bits = [](float x) {
        return std::abs(x) < std::numeric_limits<float>::min() ? 0u : std::bit_cast<uint32_t>(x);
    };
    for (int beta = 1; beta <= 2; ++beta) {
        const std::vector<float> expected = weights_on("cpu", random_paths(), beta);
        for (const std::string& backend : kernel_backends()) {
            SCOPED_TRACE(backend + ", beta " + std::to_string(beta));
            const std::vector<float> found = weights_on(backend, random_paths(), beta);
            size_t different = 0;
            for (size_t i = 0; i < found.size(); ++i) different += bits(found[i]) != bits(expected[i]);
            EXPECT_EQ(different, 0u);
        }
    }
}

// Nearly specular lobes, vertices that almost touch, and surfaces that are seen edge-on: densities of about 1e-8 to 1e8. The
// sums are bounded so that none of this gives infinity times 0.
TEST(Mis, WeightsOfExtremePathsAreNumbers) {
    for (int beta = 1; beta <= 2; ++beta) {
        Paths extreme = paths_of(Maker(2, 5, 0, 1e-4f));
        for (size_t i = 0; i < extreme.vertices.size(); i += 5) extreme.vertices[i].normal *= i % 2 == 0 ? 0.0f : 1e-8f;
        for (const std::string& backend : kernel_backends()) {
            SCOPED_TRACE(backend + ", beta " + std::to_string(beta));
            for (const float weight : weights_on(backend, extreme, beta))
                ASSERT_TRUE((weight >= 0 && weight <= 1) || weight == -1) << weight;
        }
    }
}

// The comparison can fail: weights of wrong densities sum to 1 as well, but those of many paths are off by 100 tolerances. The
// rarest mistake, of eta, is seen in a tenth of the paths; a twentieth is required.
TEST(Mis, MistakesWouldBeSeen) {
    const struct {
        const char* name;
        Mistake mistake;
    } mistakes[] = {{"shading cosine", Mistake::kShadingCosine},
                    {"no eta^2", Mistake::kNoEta},
                    {"distance to an orthographic camera", Mistake::kOrthographicDistance},
                    {"no number of light paths", Mistake::kNoLensSamples},
                    {"area density for next-event estimation", Mistake::kAreaDensityOfLight},
                    {"one connection for each strategy", Mistake::kOneConnection},
                    {"merging with a tenth of the light paths", Mistake::kFewMerged}};
    for (int beta = 1; beta <= 2; ++beta) {
        const std::vector<float> found = weights_on("cpu", random_paths(), beta);
        for (const auto& m : mistakes) {
            SCOPED_TRACE(m.name);
            uint32_t seen = 0;
            for (uint32_t i = 0; i < kPaths; ++i) {
                const std::vector<double> wrong = Reference(random_paths(), i, m.mistake).weights(beta);
                double worst = 0;
                for (uint32_t s = 0; s < kWeights; ++s)
                    worst = std::max(worst, std::abs(found[kWeights * i + s] - wrong[s]));
                if (worst > 100 * kTolerance) ++seen;
            }
            EXPECT_GT(seen, kPaths / 20);
        }
    }
}

}  // namespace
}  // namespace lampyris::test

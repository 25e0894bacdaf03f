// What a rendering cost and how wrong it is: the record behind `--stats` (schema lampyris.stats/1; docs/stats.md describes
// every key) and behind the metadata of images.
#pragma once

#include "core/image/metrics.h"
#include "core/render_session.h"
#include "core/scene/scene.h"
#include "core/version.h"

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lampyris {

// One point of error over time.
struct ConvergencePoint {
    double wall_s = 0.0;
    uint64_t passes = 0;
    double estimated_error = 0.0;
    ErrorForecast forecast{};
    bool unstable = false;
    std::optional<Metrics> against_reference;
};

struct RunRecord {
    std::string scene;
    std::string integrator;
    std::string integrator_asked;  // what the scene or the command line names; empty: nobody names one
    std::vector<std::pair<std::string, std::string>> integrator_parameters;
    std::optional<std::string> photon_map;  // of integrators that use one, and
    PhotonStatistics photons;               // what it did
    std::string backend, device;
    unsigned threads = 0;
    uint32_t seed = 0;
    std::string sampler;
    std::array<int, 2> resolution{};
    std::array<int, 4> crop{};
    double samples_per_pixel = 0.0;
    RenderProgress progress;
    double total_s = 0.0;  // from the program's start
    double parse_s = 0.0, scene_s = 0.0;
    std::map<std::string, double> phases;
    DeviceStatistics device_statistics;
    FilmSummary film;
    std::vector<ConvergencePoint> convergence;
    bool interrupted = false;
};

nlohmann::ordered_json statistics_json(const RunRecord& run, const Scene& scene);
// The same provenance as attributes of an image: "lampyris.scene", "lampyris.seed", ...
std::map<std::string, std::string> image_metadata(const RunRecord& run, const Scene& scene);

size_t peak_resident_bytes();  // of this process

}  // namespace lampyris

// What a rendering was, what it cost, how wrong it is and why it ended: what is behind `--stats` and the metadata of images.
#pragma once

#include "core/effects.h"
#include "core/image/metrics.h"
#include "core/render_session.h"

#include <array>
#include <cstdint>
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
    uint64_t scene_hash = 0;
    std::vector<EffectRequest> effects;    // that the scene calls for
    std::vector<std::string> notes;        // of the scene
    std::vector<std::string> unsupported;  // what of the scene was left out
    std::string integrator;
    std::string integrator_asked;  // what the scene or the request names; empty: nobody names one
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
    RenderEnd ended = RenderEnd::kPasses;
    double total_s = 0.0;  // with reading the scene and loading it onto the device
    double parse_s = 0.0, scene_s = 0.0;
    std::map<std::string, double> phases;
    DeviceStatistics device_statistics;
    FilmSummary film;
    std::vector<ConvergencePoint> convergence;
};

}  // namespace lampyris

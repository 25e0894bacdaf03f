// The record of a rendering: what was rendered, its cost, its error, and why it ended. Source of `--stats` and of image
// metadata.
#pragma once

#include "core/device/effects.h"
#include "core/image/metrics.h"
#include "core/render/render_session.h"

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
    std::vector<EffectRequest> effects;    // those that the scene needs
    std::vector<std::string> notes;        // of the scene
    std::vector<std::string> unsupported;  // parts of the scene that were left out
    std::string integrator;
    std::string integrator_asked;  // the name in the scene or the request; empty: none was given
    std::vector<std::pair<std::string, std::string>> integrator_parameters;
    std::optional<std::string> photon_map;  // for integrators that use one, with
    PhotonStatistics photons;               // its results
    std::string backend, device;
    unsigned threads = 0;
    uint32_t seed = 0;
    std::string sampler;
    std::array<int, 2> resolution{};
    std::array<int, 4> crop{};
    double samples_per_pixel = 0.0;
    RenderProgress progress;
    RenderEnd ended = RenderEnd::kPasses;
    double total_s = 0.0;  // including reading the scene and loading it onto the device
    double parse_s = 0.0, scene_s = 0.0;
    std::map<std::string, double> phases, counts;
    std::vector<std::pair<std::string, std::string>> choices;  // of the integrator, where its parameters leave it open
    DeviceStatistics device_statistics;
    FilmSummary film;
    std::vector<ConvergencePoint> convergence;
};

}  // namespace lampyris

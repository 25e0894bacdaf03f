#include "core/render/statistics.h"

#include "core/base/version.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>

namespace lampyris {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no NaN: what is not known is null.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json parameters_json(const std::vector<std::pair<std::string, std::string>>& parameters) {
    Json object = Json::object();
    for (const auto& [name, value] : parameters) object[name] = Json::accept(value) ? Json::parse(value) : Json(value);
    return object;
}

void add_forecast(Json& object, const ErrorForecast& forecast, bool unstable) {
    object["halving_s"] = number(forecast.halving_s);
    object["halving_low_s"] = number(forecast.low_s);
    object["halving_high_s"] = number(forecast.high_s);
    object["estimate_unstable"] = unstable;
}

Json convergence_json(const std::vector<ConvergencePoint>& points) {
    Json array = Json::array();
    for (const ConvergencePoint& point : points) {
        Json entry = {
            {"wall_s", point.wall_s}, {"passes", point.passes}, {"estimated_error", number(point.estimated_error)}};
        add_forecast(entry, point.forecast, point.unstable);
        if (point.against_reference)
            for (const MetricFormula& formula : metric_formulas())
                entry[formula.key] = number((*point.against_reference).*(formula.value));
        array.push_back(std::move(entry));
    }
    return array;
}

Json effects_json(const RunRecord& run) {
    Json array = Json::array();
    for (const EffectInfo& info : known_effects())
        for (const EffectRequest& request : run.effects)
            if (request.effect == info.effect)
                array.push_back({{"name", info.name}, {"asked_by", request.asked_by}, {"simulated", true}});
    for (const std::string& what : run.unsupported)
        array.push_back({{"name", what}, {"asked_by", what}, {"simulated", false}});
    return array;
}

Json photon_map_json(const RunRecord& run) {
    if (!run.photon_map) return nullptr;
    return {{"name", *run.photon_map}, {"parameters", parameters_json(run.photons.map_parameters)}};
}

Json radius_json(const RunRecord& run) {
    if (!run.photon_map) return nullptr;
    return {{"initial", run.photons.radius_initial},
            {"min", run.photons.radius_min},
            {"mean", run.photons.radius_mean},
            {"max", run.photons.radius_max}};
}

Json bucket_load_json(const RunRecord& run) {
    if (!run.photon_map || run.photons.bucket_load_max == 0) return nullptr;
    return {{"mean", run.photons.bucket_load_mean}, {"max", run.photons.bucket_load_max}};
}

}  // namespace

size_t peak_resident_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return size_t(usage.ru_maxrss) * 1024;
}

nlohmann::ordered_json statistics_json(const RunRecord& run) {
    Json phases = Json::object();
    for (const auto& [name, seconds] : run.phases) phases[name] = seconds;
    Json counts = Json::object();
    for (const auto& [name, value] : run.counts) counts[name] = value;
    Json kernels = Json::object();
    for (const auto& [name, seconds] : run.device_statistics.kernel_s) kernels[name] = seconds;
    Json in_vectors = Json::object();
    for (const auto& [name, invocations] : run.device_statistics.invocations)
        in_vectors[name] = double(invocations.in_vectors) / double(std::max<uint64_t>(invocations.all, 1));
    Json spirv_bytes = Json::object();
    for (const auto& [name, bytes] : run.device_statistics.spirv_bytes) spirv_bytes[name] = bytes;
    Json result = {
        {"schema", "lampyris.stats/1"},
        {"version", version()},
        {"scene", run.scene},
        {"scene_hash", fmt::format("{:016x}", run.scene_hash)},
        {"integrator",
         {{"name", run.integrator},
          {"asked", run.integrator_asked.empty() ? Json(nullptr) : Json(run.integrator_asked)},
          {"parameters", parameters_json(run.integrator_parameters)}}},
        {"photon_map", photon_map_json(run)},
        {"backend", run.backend},
        {"device", run.device},
        {"threads", run.threads},
        {"seed", run.seed},
        {"sampler", run.sampler},
        {"resolution", run.resolution},
        {"crop", run.crop},
        {"passes", run.progress.passes},
        {"samples_per_pixel", run.samples_per_pixel},
        {"wall_s", run.progress.wall_s},
        {"total_s", run.total_s},
        {"phases", phases},
        {"kernels", kernels},
        {"in_vectors", in_vectors},
        {"spirv_bytes", spirv_bytes},
        {"setup_s",
         {{"parse", run.parse_s},
          {"scene", run.scene_s},
          {"build", run.device_statistics.build_s},
          {"compile", run.device_statistics.compile_s}}},
        {"rays", run.film.rays},
        {"samples", run.film.samples},
        {"photons_emitted", run.photons.emitted},
        {"photons_stored", run.photons.stored},
        {"photons_lost", run.photons.lost},
        {"photon_map_bytes", run.photons.map_bytes},
        {"counts", counts},
        {"chosen", run.choices.empty() ? Json(nullptr) : parameters_json(run.choices)},
        {"peak_memory_bytes", peak_resident_bytes()},
        {"device_memory_bytes", run.device_statistics.peak_memory_bytes},
        {"estimated_error", number(run.progress.estimated_error)},
        {"effects", effects_json(run)},
        {"radius", radius_json(run)},
        {"bucket_load", bucket_load_json(run)},
        {"non_finite_samples", run.film.non_finite},
        {"unsupported", run.unsupported},
        {"notes", run.notes},
        {"convergence", convergence_json(run.convergence)},
        {"interrupted", run.ended == RenderEnd::kInterrupted},
    };
    add_forecast(result, run.progress.forecast, !run.progress.unstable.empty());
    if (run.progress.target != TargetState::kNone)
        result["target_reached"] = run.progress.target == TargetState::kReached;
    else
        result["target_reached"] = nullptr;
    if (run.film.non_finite > 0)
        result["first_non_finite"] = {{"x", run.film.first_non_finite[0]},
                                      {"y", run.film.first_non_finite[1]},
                                      {"pass", run.film.first_non_finite[2]}};
    return result;
}

namespace {

std::string parameters_text(const std::vector<std::pair<std::string, std::string>>& parameters) {
    std::string text;
    for (const auto& [name, value] : parameters) text += fmt::format("{}{}={}", text.empty() ? "" : ",", name, value);
    return text;
}

}  // namespace

std::map<std::string, std::string> image_metadata(const RunRecord& run) {
    return {{"lampyris.version", version()},
            {"lampyris.scene", run.scene},
            {"lampyris.scene_hash", fmt::format("{:016x}", run.scene_hash)},
            {"lampyris.integrator", run.integrator},
            {"lampyris.parameters", parameters_text(run.integrator_parameters)},
            {"lampyris.photon_map", run.photon_map.value_or("")},
            {"lampyris.photon_map_parameters", parameters_text(run.photons.map_parameters)},
            {"lampyris.backend", run.backend},
            {"lampyris.device", run.device},
            {"lampyris.seed", std::to_string(run.seed)},
            {"lampyris.sampler", run.sampler},
            {"lampyris.passes", std::to_string(run.progress.passes)},
            {"lampyris.wall_s", fmt::format("{:.3f}", run.progress.wall_s)}};
}

}  // namespace lampyris

#include "commands/replay.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>

namespace lampyris {
namespace {

using Json = nlohmann::ordered_json;
using kernel::PathLogRecord;

// What each strategy of a bidirectional method adds to the first pixel: its share, weighed and alone. Those that add nothing
// are left out.
Json strategies_of(const Image& image) {
    Json list = Json::array();
    const std::string_view prefix = "strategy.", suffix = ".R";
    for (const std::string& channel : image.channel_names) {
        if (!channel.starts_with(prefix) || !channel.ends_with(suffix)) continue;
        const std::string name = channel.substr(prefix.size(), channel.size() - prefix.size() - suffix.size());
        const auto rgb = [&](const std::string& layer) {
            std::array<float, 3> value{};
            for (size_t c = 0; c < 3; ++c)
                value[c] = image.at(0, 0, image.find_channel(fmt::format("{}.{}.{}", layer, name, "RGB"[c])));
            return value;
        };
        const std::array<float, 3> weighed = rgb("strategy"), alone = rgb("alone");
        if (alone == std::array<float, 3>{}) continue;
        list.push_back({{"strategy", name}, {"radiance", weighed}, {"alone", alone}});
    }
    return list;
}

// ---- Numbers ---------------------------------------------------------------------------------------------------------

// As few digits as identify the float.
Json number(float x) {
    if (!std::isfinite(x)) return std::isnan(x) ? "nan" : (x > 0.0f ? "inf" : "-inf");
    return std::strtod(fmt::format("{}", x).c_str(), nullptr);
}
Json numbers(const glm::vec3& v) { return {number(v.x), number(v.y), number(v.z)}; }
Json numbers(const glm::dvec3& v) { return numbers(glm::vec3(v)); }

// ---- Events ----------------------------------------------------------------------------------------------------------

constexpr std::array kMaterials{LAMPYRIS_MATERIAL_NAMES};
constexpr std::array kPaths{"camera", "light", "chain"};
constexpr std::array kEvents{"start", "vertex",     "scatter", "roulette", "pass",    "escape", "emission",
                             "light", "connection", "splat",   "merge",    "discard", "sample", "mutation"};
constexpr std::array kSeen{"clearly", "occluded", "not scattered"};

std::string lobe_text(uint32_t lobe) {
    const char* side = lobe & kernel::LOBE_TRANSMISSION ? "transmission" : "reflection";
    const char* kind = lobe & kernel::LOBE_SPECULAR ? "specular" : lobe & kernel::LOBE_GLOSSY ? "glossy" : "diffuse";
    return fmt::format("{} {}", kind, side);
}

void add_medium(Json& json, uint32_t medium) {
    if (medium != kernel::MEDIUM_VACUUM) json["medium"] = medium;
}

void add_start(Json& json, const PathLogRecord& r) {
    if (r.light != kernel::NONE) {
        json["light"] = r.light;
        json["place_pdf"] = number(r.pdf);
        json["direction_pdf"] = number(r.extra);
    }
    json["position"] = numbers(r.position);
    json["direction"] = numbers(r.direction);
    json["throughput"] = numbers(r.throughput);
    add_medium(json, r.medium);
}

void add_vertex(Json& json, const PathLogRecord& r) {
    json["position"] = numbers(r.position);
    json["distance"] = number(r.distance);
    json["normal"] = numbers(r.normal);
    json["geometric_normal"] = numbers(r.value);
    json["material"] = kMaterials.at(r.material);
    json["geometry"] = r.partner;
    json["primitive"] = r.detail;
    if (r.light != kernel::NONE) json["light"] = r.light;
    json["throughput"] = numbers(r.throughput);
    add_medium(json, r.medium);
}

void add_scatter(Json& json, const PathLogRecord& r) {
    json["lobe"] = lobe_text(r.detail);
    json["direction"] = numbers(r.direction);
    json[r.detail & kernel::LOBE_SPECULAR ? "probability" : "pdf"] = number(r.pdf);
    if (r.extra != 1.0f) json["eta"] = number(r.extra);
    json["throughput"] = numbers(r.throughput);
}

void add_light(Json& json, const PathLogRecord& r) {
    json["light"] = r.light == kernel::NONE ? Json("environment") : Json(r.light);
    if (r.event == kernel::LOG_LIGHT) {
        json["seen"] = kSeen.at(r.detail);
        json["pdf"] = number(r.pdf);
        json["bsdf_pdf"] = number(r.extra);
        json["direction"] = numbers(r.direction);
    } else if (r.light != kernel::NONE) {
        json["position"] = numbers(r.position);
    }
    if (r.distance < 1e38f) json["distance"] = number(r.distance);
}

void add_merge(Json& json, const PathLogRecord& r) {
    json["light_path"] = r.partner;
    json["position"] = numbers(r.position);
    json["direction"] = numbers(r.direction);
    json["power"] = numbers(r.throughput);
    if (r.extra != 1.0f) json["stands_for"] = number(r.extra);
}

void add_details(Json& json, const PathLogRecord& r) {
    switch (r.event) {
        case kernel::LOG_START: return add_start(json, r);
        case kernel::LOG_VERTEX: return add_vertex(json, r);
        case kernel::LOG_SCATTER: return add_scatter(json, r);
        case kernel::LOG_EMISSION:
        case kernel::LOG_LIGHT: return add_light(json, r);
        case kernel::LOG_MERGE: return add_merge(json, r);
        case kernel::LOG_ROULETTE:
            json["chance"] = number(r.extra);
            json["goes_on"] = r.detail == 0;
            return;
        case kernel::LOG_PASS:
            json["through"] = r.detail == kernel::LOG_PASS_MASK ? "mask" : "interface";
            json["position"] = numbers(r.position);
            return add_medium(json, r.medium);
        case kernel::LOG_ESCAPE:
            json["direction"] = numbers(r.direction);
            json["throughput"] = numbers(r.throughput);
            return;
        case kernel::LOG_CONNECTION:
            if (r.partner != kernel::NONE) json["light_path"] = r.partner;
            json["seen"] = kSeen.at(r.detail);
            json["to"] = numbers(r.position);
            json["distance"] = number(r.distance);
            return;
        case kernel::LOG_SPLAT:
            if (r.kind == kernel::LOG_CHAIN) {
                json["times"] = number(r.extra);
                return;
            }
            json["from"] = numbers(r.position);
            json["distance"] = number(r.distance);
            return;
        case kernel::LOG_SAMPLE: json["factor"] = number(r.factor); return;
        case kernel::LOG_MUTATION:
            json["number"] = r.depth;
            json["large"] = r.detail != 0;
            json["chance"] = number(r.extra);
            json["luminance"] = number(r.pdf);
            return;
        default: return;
    }
}

Json event_of(const PathEvent& event) {
    const PathLogRecord& r = event.record;
    Json json = {{"event", kEvents.at(r.event)}};
    if (r.event >= kernel::LOG_VERTEX && r.event <= kernel::LOG_ROULETTE) json["vertex"] = r.depth + 1;
    if (r.event >= kernel::LOG_LIGHT && r.event <= kernel::LOG_MERGE &&
        !(r.kind == kernel::LOG_CHAIN && r.event == kernel::LOG_SPLAT))
        json["vertex"] = r.depth + 1;
    if (r.s != kernel::NONE) json["s"] = r.s, json["t"] = r.t;
    add_details(json, r);
    if (event.unweighted) {
        json["unweighted"] = numbers(*event.unweighted);
        json["weight"] = number(r.weight);
        json["added"] = numbers(event.added());
    } else if (r.kind == kernel::LOG_CHAIN && r.event >= kernel::LOG_EMISSION && r.event <= kernel::LOG_CONNECTION) {
        json["radiance"] = numbers(r.value);  // of a proposal; what the chain adds are splats
        json["weight"] = number(r.weight);
    }
    return json;
}

// The paths, each with its events.
Json paths_of(const PathLog& log) {
    Json paths = Json::array();
    const PathLogRecord* last = nullptr;
    for (const PathEvent& event : log.events) {
        const PathLogRecord& r = event.record;
        if (!last || r.kind != last->kind || r.path != last->path)
            paths.push_back({{"path", kPaths.at(r.kind)}, {"number", r.path}, {"events", Json::array()}});
        paths.back()["events"].push_back(event_of(event));
        last = &r;
    }
    return paths;
}

glm::dvec3 sum_of(const PathLog& log) {
    glm::dvec3 sum(0.0);
    for (const PathEvent& event : log.events) sum += event.added();
    return sum;
}

// Whether the log can have all that is added to the pixel: events for which there was no room may be what the others' values need, and
// integrators need not log what they add.
bool adds_up(const PathLog& log) {
    const auto adds = [](const PathEvent& event) { return event.unweighted.has_value(); };
    const auto samples = [](const PathEvent& event) {
        return event.record.event == kernel::LOG_SAMPLE && event.record.value != glm::vec3(0.0f);
    };
    const auto& events = log.events;
    return log.missing == 0 &&
           (std::any_of(events.begin(), events.end(), adds) || std::none_of(events.begin(), events.end(), samples));
}

// ---- Text ------------------------------------------------------------------------------------------------------------

bool has_object_inside(const Json& json) {
    for (const Json& child : json)
        if (child.is_object() || (child.is_structured() && has_object_inside(child))) return true;
    return false;
}

// What contains no object is one line.
void write(std::string& out, const Json& json, size_t indent) {
    if (!json.is_structured()) {
        out += json.dump();
        return;
    }
    const bool lines = indent == 0 || has_object_inside(json);
    const char* brackets = json.is_object() ? "{}" : "[]";
    out += brackets[0];
    bool first = true;
    for (const auto& [key, value] : json.items()) {
        if (!first) out += lines ? "," : ", ";
        if (lines) out += "\n" + std::string(indent + 2, ' ');
        if (json.is_object()) out += Json(key).dump() + ": ";
        write(out, value, indent + 2);
        first = false;
    }
    if (lines) out += "\n" + std::string(indent, ' ');
    out += brackets[1];
}

}  // namespace

std::string replay_text(const RenderOutcome& outcome, const std::array<int, 3>& replay) {
    const kernel::FilmPixel& p = outcome.pixels[0];
    Json json = {{"schema", "lampyris.replay/1"},
                 {"pixel", {replay[0], replay[1]}},
                 {"pass", replay[2]},
                 {"backend", outcome.record.backend},
                 {"radiance", {p.sum.x, p.sum.y, p.sum.z}},
                 {"weight", p.weight},
                 {"rays", p.rays},
                 {"non_finite", p.left_out},
                 {"normal", {p.normal.x, p.normal.y, p.normal.z}},
                 {"albedo", {p.albedo.x, p.albedo.y, p.albedo.z}},
                 {"depth", p.depth}};
    if (const Json strategies = strategies_of(outcome.image); !strategies.empty()) json["strategies"] = strategies;
    json["sum_of_events"] = adds_up(outcome.paths) ? numbers(sum_of(outcome.paths)) : Json();
    if (outcome.paths.missing > 0) json["events_missing"] = outcome.paths.missing;
    if (outcome.paths.light_paths_missing > 0) json["light_paths_missing"] = outcome.paths.light_paths_missing;
    json["paths"] = paths_of(outcome.paths);
    std::string text;
    write(text, json, 0);
    return text + "\n";
}

}  // namespace lampyris

#include "core/render/checkpoint.h"

#include "core/base/error.h"
#include "core/base/file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <stdexcept>
#include <string_view>
#include <system_error>

namespace lampyris {
namespace {

using Json = nlohmann::ordered_json;

// The file: this line; the length of the JSON text, 8 bytes; the text; the film; the parts; and a hash of all that, 8 bytes.
constexpr std::string_view kMagic = "lampyris checkpoint 1\n";
constexpr const char* kSchema = "lampyris.checkpoint/1";
constexpr uint64_t kMostText = 1u << 24;
constexpr uint64_t kMostCount = uint64_t(1) << 60;
constexpr double kMostSeconds = 1e10;

template <typename T>
void append(std::vector<std::byte>& bytes, const T* data, size_t count) {
    const auto* first = reinterpret_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), first, first + count * sizeof(T));
}

// JSON has no NaN.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
double number(const Json& value) {
    return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

Json point_json(const ConvergencePoint& p) {
    Json json{{"wall_s", p.wall_s},
              {"passes", p.passes},
              {"error", number(p.estimated_error)},
              {"halving", {number(p.forecast.halving_s), number(p.forecast.low_s), number(p.forecast.high_s)}},
              {"unstable", p.unstable}};
    if (!p.against_reference) return json;
    const Metrics& m = *p.against_reference;
    Json& metrics = json["metrics"];
    for (const MetricFormula& formula : metric_formulas()) metrics[formula.key] = number(m.*formula.value);
    for (size_t i = 0; i < 3; ++i) {
        metrics["mean"].push_back(number(m.mean[i]));
        metrics["reference_mean"].push_back(number(m.reference_mean[i]));
    }
    metrics["pixels"] = m.pixels;
    metrics["non_finite"] = m.non_finite;
    return json;
}

ConvergencePoint point_of(const Json& json) {
    ConvergencePoint p;
    p.wall_s = json.at("wall_s");
    p.passes = json.at("passes");
    p.estimated_error = number(json.at("error"));
    const Json& halving = json.at("halving");
    p.forecast = {number(halving.at(0)), number(halving.at(1)), number(halving.at(2))};
    p.unstable = json.at("unstable");
    if (!json.contains("metrics")) return p;
    const Json& metrics = json.at("metrics");
    Metrics m;
    for (const MetricFormula& formula : metric_formulas()) m.*formula.value = number(metrics.at(formula.key));
    for (size_t i = 0; i < 3; ++i) {
        m.mean[i] = number(metrics.at("mean").at(i));
        m.reference_mean[i] = number(metrics.at("reference_mean").at(i));
    }
    m.pixels = metrics.at("pixels");
    m.non_finite = metrics.at("non_finite");
    p.against_reference = m;
    return p;
}

Json text_of(const Checkpoint& c) {
    Json json{{"schema", kSchema}};
    for (const auto& [name, value] : c.identity) json["rendering"].push_back({name, value});
    const SessionState& s = c.session;
    json["passes"] = s.passes;
    json["wall_s"] = s.wall_s;
    json["total_s"] = c.total_s;
    json["history"] = Json::array();
    for (const ErrorPoint& p : s.history) json["history"].push_back({p.passes, p.wall_s, number(p.error)});
    json["phases"] = s.phases;
    json["counts"] = s.counts;
    json["photons"] = {s.photons.emitted, s.photons.stored, s.photons.lost, s.photons.rays};
    json["convergence"] = Json::array();
    for (const ConvergencePoint& p : c.convergence) json["convergence"].push_back(point_json(p));
    json["pixels"] = c.film.size();
    json["parts"] = Json::array();
    for (const SessionState::Part& part : s.parts) json["parts"].push_back({part.name, part.bytes.size()});
    return json;
}

uint64_t count_of(const Json& json) {
    if (!json.is_number_unsigned() || json.get<uint64_t>() > kMostCount)
        throw std::out_of_range("a number is out of range");
    return json;
}

double seconds_of(const Json& json) {
    const double seconds = json;
    if (!(seconds >= 0.0 && seconds < kMostSeconds)) throw std::out_of_range("a time is out of range");
    return seconds;
}

Checkpoint checkpoint_of(const Json& json, std::span<const std::byte> binary) {
    Checkpoint c;
    if (json.at("schema") != kSchema) throw std::out_of_range("it is of another version");
    for (const Json& pair : json.at("rendering")) c.identity.emplace_back(pair.at(0), pair.at(1));
    SessionState& s = c.session;
    s.passes = count_of(json.at("passes"));
    s.wall_s = seconds_of(json.at("wall_s"));
    c.total_s = seconds_of(json.at("total_s"));
    for (const Json& p : json.at("history")) {
        s.history.push_back({count_of(p.at(0)), seconds_of(p.at(1)), number(p.at(2))});
        if (s.history.size() > 1 && s.history.back().passes <= s.history[s.history.size() - 2].passes)
            throw std::out_of_range("its history is not in order");
    }
    if (s.history.empty() || s.history.back().passes > s.passes) throw std::out_of_range("its history is not its own");
    s.phases = json.at("phases").get<std::map<std::string, double>>();
    s.counts = json.at("counts").get<std::map<std::string, double>>();
    const Json& photons = json.at("photons");
    s.photons.emitted = count_of(photons.at(0));
    s.photons.stored = count_of(photons.at(1));
    s.photons.lost = count_of(photons.at(2));
    s.photons.rays = count_of(photons.at(3));
    for (const Json& p : json.at("convergence")) c.convergence.push_back(point_of(p));
    const auto take = [&](size_t bytes) {
        if (bytes > binary.size()) throw std::out_of_range("its parts are longer than the file");
        const std::span<const std::byte> taken = binary.first(bytes);
        binary = binary.subspan(bytes);
        return taken;
    };
    const size_t pixels = count_of(json.at("pixels"));
    if (pixels == 0) throw std::out_of_range("its film has no pixels");
    if (pixels > binary.size() / sizeof(kernel::FilmPixel)) throw std::out_of_range("its film is longer than the file");
    c.film.resize(pixels);
    std::memcpy(c.film.data(), take(pixels * sizeof(kernel::FilmPixel)).data(), pixels * sizeof(kernel::FilmPixel));
    for (const Json& part : json.at("parts")) {
        const std::span<const std::byte> bytes = take(count_of(part.at(1)));
        s.parts.push_back({part.at(0), {bytes.begin(), bytes.end()}});
    }
    if (!binary.empty()) throw std::out_of_range("it is longer than its parts");
    return c;
}

// Nothing if it does not begin as a checkpoint.
std::vector<std::byte> read_all(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    std::error_code error;
    const uintmax_t size = std::filesystem::file_size(file, error);
    std::string begin(kMagic.size(), ' ');
    stream.read(begin.data(), std::streamsize(begin.size()));
    if (stream.gcount() == 0 || begin != kMagic) return {};  // before memory is asked for
    stream.seekg(0);
    if (!stream || error) throw MachineError(fmt::format("error: cannot read the checkpoint '{}'", shown(file)));
    std::vector<std::byte> bytes(size);
    stream.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size));
    if (uintmax_t(stream.gcount()) != size)
        throw MachineError(fmt::format("error: cannot read the checkpoint '{}'", shown(file)));
    return bytes;
}

}  // namespace

uint64_t checkpoint_hash(std::span<const std::byte> bytes) {
    uint64_t hash = 0xcbf29ce484222325u ^ bytes.size();
    for (size_t i = 0; i < bytes.size(); i += 8) {
        uint64_t word = 0;
        std::memcpy(&word, bytes.data() + i, std::min<size_t>(8, bytes.size() - i));
        hash = (hash ^ word) * 0x100000001b3u;
        hash ^= hash >> 29;
    }
    return hash;
}

void write_checkpoint(const std::string& file, const Checkpoint& checkpoint) {
    const std::string text = text_of(checkpoint).dump(-1, ' ', false, Json::error_handler_t::replace);
    const uint64_t length = text.size();
    std::vector<std::byte> bytes;
    append(bytes, kMagic.data(), kMagic.size());
    append(bytes, &length, 1);
    append(bytes, text.data(), text.size());
    append(bytes, checkpoint.film.data(), checkpoint.film.size());
    for (const SessionState::Part& part : checkpoint.session.parts) append(bytes, part.bytes.data(), part.bytes.size());
    const uint64_t hash = checkpoint_hash(bytes);
    append(bytes, &hash, 1);
    write_file_atomically(file, bytes);
}

std::optional<Checkpoint> read_checkpoint(const std::string& file) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status)) return std::nullopt;
    const auto fail = [&](std::string_view why) {
        return InputError(fmt::format("error: '{}' is no checkpoint that can be resumed: {}", shown(file), why));
    };
    if (!std::filesystem::is_regular_file(status)) throw fail("it is no regular file");
    const std::vector<std::byte> bytes = read_all(file);
    const size_t head = kMagic.size() + 8;
    if (bytes.size() < head + 8 || std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0)
        throw fail("it does not begin as one of this version does");
    const std::span<const std::byte> all(bytes);
    uint64_t hash = 0, length = 0;
    std::memcpy(&hash, bytes.data() + bytes.size() - 8, 8);
    std::memcpy(&length, bytes.data() + kMagic.size(), 8);
    const std::span<const std::byte> content = all.first(bytes.size() - 8);
    if (hash != checkpoint_hash(content)) throw fail("its content is damaged (the hash differs)");
    if (length > kMostText || length > content.size() - head) throw fail("its text is longer than the file");
    const auto* text = reinterpret_cast<const char*>(bytes.data() + head);
    try {
        return checkpoint_of(Json::parse(text, text + length), content.subspan(head + length));
    } catch (const std::exception& wrong) {
        throw fail(wrong.what());
    }
}

void check_same_rendering(const std::string& file, const RenderIdentity& saved, const RenderIdentity& now) {
    const std::map<std::string, std::string> before(saved.begin(), saved.end());
    std::vector<std::string> differences;
    for (const auto& [name, value] : now) {
        const auto found = before.find(name);
        if (found == before.end())
            differences.push_back(fmt::format("it has no {}", name));
        else if (found->second != value)
            differences.push_back(fmt::format("its {} is {}, here it is {}", name, shown(found->second), shown(value)));
    }
    if (differences.empty() && saved.size() != now.size()) differences.push_back("it has settings that this one lacks");
    if (!differences.empty())
        throw InputError(fmt::format("error: '{}' is the checkpoint of another rendering: {}", shown(file),
                                     fmt::join(differences, "; ")));
}

void check_checkpoint_file(const std::string& file, bool resume) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    if (std::filesystem::exists(status)) {
        if (!std::filesystem::is_regular_file(status))
            throw InputError(fmt::format("error: --checkpoint '{}': it is no regular file", shown(file)));
        if (!resume)
            throw InputError(fmt::format(
                "error: --checkpoint '{}': there is such a file already: go on with it (--resume), or remove it",
                shown(file)));
    }
    check_writable(file);
}

}  // namespace lampyris

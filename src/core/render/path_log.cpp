#include "core/render/path_log.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace lampyris {
namespace {

using kernel::PathLogRecord;

constexpr uint32_t kCapacity = 1u << 16;
// Of the record that closes a path when there is no room for others, and of its event, which is NONE if nothing was written there.
constexpr size_t kLastPlace = size_t(kCapacity) * sizeof(PathLogRecord) + offsetof(PathLogRecord, event);
constexpr size_t kMostLightPaths = 1024;  // that are traced again, each in a run of its own

// By path, and on a path by order. Photons are merged in any order, and have the same one.
auto place_of(const PathLogRecord& r) {
    return std::tuple(r.kind, r.path, r.order, r.depth, r.partner, r.detail, r.event);
}

bool contributes(const PathLogRecord& r) {
    if (r.kind == kernel::LOG_CAMERA_PATH)
        return r.event == kernel::LOG_EMISSION || r.event == kernel::LOG_LIGHT || r.event == kernel::LOG_CONNECTION ||
               r.event == kernel::LOG_MERGE;
    return r.event == kernel::LOG_SPLAT;
}

// What the contributions of a path are multiplied by to enter the pixel.
class PathFactors {
 public:
    explicit PathFactors(const std::vector<PathLogRecord>& records) {
        for (const PathLogRecord& r : records) {
            const std::pair path(r.kind, r.kind == kernel::LOG_CHAIN ? 0 : r.path);
            if (r.event == kernel::LOG_SAMPLE) factors_[path] = double(r.factor);
            if (r.event == kernel::LOG_DISCARD) discarded_[path] = r.order;
        }
    }
    std::optional<double> of(const PathLogRecord& r) const {
        if (r.kind == kernel::LOG_LIGHT_PATH) return 1.0;  // splats enter the pixel themselves
        const std::pair path(r.kind, r.kind == kernel::LOG_CHAIN ? 0 : r.path);
        const auto discarded = discarded_.find(path);
        if (discarded != discarded_.end() && r.order < discarded->second) return 0.0;
        const auto found = factors_.find(path);
        return found == factors_.end() ? std::nullopt : std::optional(found->second);
    }

 private:
    std::map<std::pair<uint32_t, uint32_t>, double> factors_;
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> discarded_;
};

}  // namespace

PathLogger::PathLogger(Device& device)
    : device_(device), buffer_(device.create_buffer((size_t(kCapacity) + 1) * sizeof(PathLogRecord), "the path log")) {
    PathLogRecord header{};
    header.kind = kCapacity;
    header.path = kernel::LOG_MODE_PIXEL;
    buffer_->upload(&header, sizeof header);
    buffer_->upload(&kernel::NONE, sizeof kernel::NONE, kLastPlace);
    device_.set_path_log(buffer_);
}

PathLogger::~PathLogger() { device_.set_path_log(nullptr); }

void PathLogger::set_mode(uint32_t mode) { buffer_->upload(&mode, sizeof mode, offsetof(PathLogRecord, path)); }

void PathLogger::photons_are_of(uint32_t first_path, uint32_t paths) {
    buffer_->upload(&first_path, sizeof first_path, offsetof(PathLogRecord, order));
    buffer_->upload(&paths, sizeof paths, offsetof(PathLogRecord, depth));
}

uint64_t PathLogger::asked() const {
    PathLogRecord header;
    buffer_->download(&header, sizeof header);
    return header.event;
}

std::vector<PathLogRecord> PathLogger::records(uint64_t* written) const {
    std::vector<PathLogRecord> records(std::min<uint64_t>(asked(), kCapacity));
    buffer_->download(records.data(), records.size() * sizeof records[0], sizeof records[0]);
    if (!records.empty() && records.back().event == kernel::NONE) records.pop_back();
    if (written) *written = records.size();
    std::sort(records.begin(), records.end(),
              [](const PathLogRecord& a, const PathLogRecord& b) { return place_of(a) < place_of(b); });
    // A kernel that ran again because a buffer was too small logged the same.
    const auto same = [](const PathLogRecord& a, const PathLogRecord& b) { return place_of(a) == place_of(b); };
    records.erase(std::unique(records.begin(), records.end(), same), records.end());
    return records;
}

void PathLogger::follow_light_paths(const std::function<void(uint32_t)>& run) {
    std::set<uint32_t> paths;
    for (const PathLogRecord& r : records()) {
        if (r.kind == kernel::LOG_LIGHT_PATH) paths.insert(r.path);
        if (r.partner != kernel::NONE && (r.event == kernel::LOG_CONNECTION || r.event == kernel::LOG_MERGE))
            paths.insert(r.partner);
    }
    set_mode(kernel::LOG_MODE_LIGHT_PATHS);
    size_t count = 0;
    for (const uint32_t path : paths) {
        if (count++ == kMostLightPaths) break;
        run(path);
    }
    light_paths_missing_ = paths.size() - std::min(paths.size(), kMostLightPaths);
    set_mode(kernel::LOG_MODE_OFF);
}

void PathLogger::stop() { set_mode(kernel::LOG_MODE_OFF); }

void PathLogger::go_on() { set_mode(kernel::LOG_MODE_PIXEL); }

PathLog PathLogger::log() const {
    uint64_t written = 0;
    const std::vector<PathLogRecord> found = records(&written);
    const PathFactors factors(found);
    PathLog log;
    log.missing = asked() - written;
    log.light_paths_missing = light_paths_missing_;
    for (const PathLogRecord& r : found) {
        PathEvent& event = log.events.emplace_back(PathEvent{r, {}});
        if (!contributes(r)) continue;
        if (const std::optional<double> factor = factors.of(r))
            event.unweighted = glm::dvec3(r.value) * (double(r.factor) * *factor);
    }
    return log;
}

}  // namespace lampyris

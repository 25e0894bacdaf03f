// The log of a replay: what happened to the paths that contribute to one pixel in one pass.
#pragma once

#include "core/device/device.h"
#include "core/device/kernel_types.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace lampyris {

// An event, and what it would add to the pixel's sum without its weight. That is absent where nothing is added, or where the
// integrator does not say by which factor the path counts.
struct PathEvent {
    kernel::PathLogRecord record;
    std::optional<glm::dvec3> unweighted;
    glm::dvec3 added() const { return unweighted.value_or(glm::dvec3(0.0)) * double(record.weight); }
};

// Events path by path, in the order in which they happened: the same for any number of threads.
struct PathLog {
    std::vector<PathEvent> events;
    uint64_t missing = 0;              // events for which there was no room
    uint64_t light_paths_missing = 0;  // light paths that contribute, and whose vertices are not logged
};

// While it lives, kernels that are compiled with EFFECT_PATH_LOG write to it.
class PathLogger {
 public:
    explicit PathLogger(Device& device);
    ~PathLogger();
    PathLogger(const PathLogger&) = delete;
    PathLogger& operator=(const PathLogger&) = delete;

    // To be called before photons are gathered: their keys are those of `paths` light paths, the first of which has this number.
    void photons_are_of(uint32_t first_path, uint32_t paths);
    // Logs the vertices of the light paths that contribute to the pixel: `run` traces one path again.
    void follow_light_paths(const std::function<void(uint32_t path)>& run);
    void stop();  // kernels that run from now on log nothing
    void go_on();

    PathLog log() const;

 private:
    void set_mode(uint32_t mode);
    // In order, each once; `written`: how many there are with those that were logged twice.
    std::vector<kernel::PathLogRecord> records(uint64_t* written = nullptr) const;
    uint64_t asked() const;  // records, including those that did not fit
    Device& device_;
    BufferHandle buffer_;
    uint64_t light_paths_missing_ = 0;
};

}  // namespace lampyris

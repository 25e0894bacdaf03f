#include "integrators/bidirectional/bidirectional_host.h"

#include "core/base/error.h"
#include "core/render/integrator.h"
#include "integrators/bidirectional/bidirectional.h"
#include "integrators/path/path_params.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>

namespace lampyris {

float splat_quantum(const Scene& scene) {
    const double radius = double(scene.record.bounds.w);
    const double radiance =
        double(scene.record.light_power) / (4.0 * std::numbers::pi * std::numbers::pi * radius * radius);
    return float(std::clamp(radiance * 0x1p-24, 1e-36, 1e20));
}

float film_density(const Scene& scene) {
    const kernel::CameraRecord& camera = scene.record.camera;
    const float filter_area = 4.0f * camera.filter_radius_x * camera.filter_radius_y;  // in pixels
    return 1.0f / std::clamp(filter_area, 1e-12f, 1.0f);
}

size_t splat_bytes(uint32_t pixels, const char* integrator) {
    constexpr uint32_t kMost = std::numeric_limits<uint32_t>::max() / kernel::SPLAT_WORDS;
    if (pixels > kMost)
        throw InputError(
            fmt::format("error: \"{}\" renders at most {} pixels at once; render parts (--crop)", integrator, kMost));
    return size_t(pixels) * kernel::SPLAT_WORDS * 4;
}

void check_connections(const BidirectionalOptions& options) {
    if (options.cache > 0 && options.connections >= 0)
        throw InputError(fmt::format(
            "error: {} with cache={} connects to the vertices of many light paths, and connections={} chooses among "
            "those of one: give either",
            options.name, options.cache, options.connections));
}

uint32_t light_path_count(const BidirectionalOptions& options, const Scene& scene) {
    return options.lightpaths > 0 ? uint32_t(options.lightpaths) : scene.width() * scene.height();
}

void render_camera_paths(RenderSession& session, const BidirectionalOptions& options) {
    const PathParams params{.maxdepth = options.maxdepth, .rrdepth = options.rrdepth};
    render_samples(session, "integrators/path/path.radiance.h", &params, sizeof params);
}

}  // namespace lampyris

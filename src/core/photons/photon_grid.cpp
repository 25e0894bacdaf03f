#include "core/photons/photon_grid.h"

#include <algorithm>
#include <cmath>

namespace lampyris {
namespace {

constexpr float kSmallestCell = 1e-15f;
constexpr float kLargestCell = 1e30f;

// Sebastiano Vigna's splitmix64.
uint64_t next(uint64_t& state) {
    uint64_t x = (state += 0x9e3779b97f4a7c15u);
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

}  // namespace

kernel::PhotonGrid make_grid(const PhotonSet& photons, float multiple) {
    const auto finite = [](float x) { return std::clamp(std::isfinite(x) ? x : 0.0f, -1e30f, 1e30f); };
    glm::vec3 low, extent;
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = finite(photons.low[axis]);
        extent[axis] = std::max(finite(photons.high[axis]) - low[axis], 0.0f);
    }
    const float largest = std::max({extent.x, extent.y, extent.z});
    // One cell less than the maximum, because the origin's jitter may add one.
    const float least = std::max(largest / float(kernel::GRID_MAX_CELLS - 2), kSmallestCell);
    const float cell = std::clamp(finite(multiple * photons.radius), least, std::max(kLargestCell, least));

    uint64_t state = uint64_t(photons.seed) << 32 | photons.pass;
    kernel::PhotonGrid grid{};
    grid.origin.w = 1.0f / cell;
    for (int axis = 0; axis < 3; ++axis) {
        grid.origin[axis] = low[axis] - cell * (float(next(state) >> 40) * 0x1p-24f);
        const float cells = (low[axis] + extent[axis] - grid.origin[axis]) * grid.origin.w;
        grid.resolution[axis] = uint32_t(std::clamp(cells, 0.0f, float(kernel::GRID_MAX_CELLS - 1))) + 1;
    }
    grid.resolution.w = uint32_t(next(state) >> 32);
    grid.count = photons.count;
    return grid;
}

uint32_t table_entries(const PhotonSet& photons, float per_photon) {
    return uint32_t(std::clamp(double(photons.count) * double(per_photon), 1.0, double(1u << 30)));
}

}  // namespace lampyris

#include "core/photons/photon_grid.h"
#include "accel/photons/uniform_grid/uniform_grid_params.h"

#include <algorithm>

namespace lampyris {
namespace {

class UniformGrid : public PhotonMap {
 public:
    UniformGridParams params;
    PhotonMapCapabilities capabilities() const override {
        return {.exact = !drops(), .lossy = drops(), .fixed_order = !drops()};
    }
    // The atomic counts; the accesses are to the slot and its key.
    ConstructionTraffic traffic() const override { return {.accesses = 2, .atomics = 1}; }

 protected:
    static constexpr const char* kStore = "accel/photons/uniform_grid/uniform_grid_store.kernel.h";
    static constexpr const char* kOrder = "accel/photons/uniform_grid/uniform_grid_order.kernel.h";
    std::vector<std::string> kernels() const override { return {kStore, kOrder}; }
    bool drops() const { return params.overflow == 1; }

    // Enlarges the cells until there are no more of them than the parameter `cells` allows.
    kernel::PhotonGrid bounded_grid(PhotonSet photons) const {
        const double most = std::clamp(double(photons.count) * double(params.cells), 64.0, double(1u << 28));
        photons.radius = std::max(photons.radius, 1e-20f);
        for (;;) {
            const kernel::PhotonGrid grid = make_grid(photons, params.cell_size);
            if (double(grid.resolution.x) * double(grid.resolution.y) * double(grid.resolution.z) <= most) return grid;
            photons.radius *= 1.05f;
        }
    }

    void construct(const PhotonSet& photons) override {
        kernel::PhotonGrid grid = bounded_grid(photons);
        const uint32_t cells = grid.resolution.x * grid.resolution.y * grid.resolution.z;
        grid.entries = cells;
        grid.capacity = params.capacity;
        grid.option = params.overflow;
        upload("grid", grid);
        const BufferHandle counts = keep("counts", size_t(cells) * 8);
        keep("slots", size_t(cells) * params.capacity * 16);
        keep("keys", size_t(cells) * params.capacity * 4);
        const BufferHandle nodes = keep("nodes", drops() ? 16 : size_t(photons.count) * 16);
        const BufferHandle dropped = upload("dropped", uint32_t(0));
        clear(counts, size_t(cells) * 8);
        run(kStore, span_count(photons.count));
        run(kOrder, batch_count(cells), {{"links", nodes}});
        if (!drops()) return;
        uint32_t lost = 0;
        dropped->download(&lost, sizeof lost);
        statistics_.lost_photons += lost;
    }
};

REGISTER_PHOTON_MAP(UniformGrid, UNIFORM_GRID_PARAMS, "uniform_grid",
                    "A grid over the whole box, each cell with room for a few photons and a list for the rest.")

}  // namespace
}  // namespace lampyris

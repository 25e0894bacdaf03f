// Photons that are traced once and kept, and the structure that looks them up.
#pragma once

#include "core/photons/photon_map.h"
#include "core/render/render_session.h"
#include "integrators/photon_paths/photon_paths_host.h"

#include <memory>

namespace lampyris {

class StoredPhotons {
 public:
    // `keep`: kernel::SPPM_KEEP_*. `stream` makes the random numbers of several maps independent. Compiles everything
    // that building and gathering need.
    StoredPhotons(RenderSession& session, uint32_t keep, uint32_t paths, uint32_t stream,
                  const PhotonConsumer& consumer);

    // Traces the paths, once. `parameters`: ProgressiveParams for sppm's kernels. Throws InputError if there are not enough
    // keys.
    void trace(const BufferHandle& parameters);

    // Passes the photons found by `count` queries, none with a radius above `radius`, to the consumer. Builds the
    // structure first if there is none, or if it is valid only for other queries or another pass.
    void gather(const BufferHandle& queries, uint32_t count, float radius, uint64_t pass);

    uint32_t count() const { return stored_; }
    PhotonMap& map() { return *map_; }
    // Adds its statistics to the session's.
    void finish() const;

 private:
    void build(const BufferHandle& queries, uint32_t count, float radius, uint64_t pass);

    RenderSession& session_;
    const uint32_t paths_;
    kernel::PhotonPass pass_{};
    KernelHandle kernel_;
    BufferHandle store_;
    uint32_t stored_ = 0;
    std::unique_ptr<PhotonMap> map_;
    PhotonConsumer consumer_;
    bool built_ = false;
    uint64_t built_for_ = 0;
};

}  // namespace lampyris

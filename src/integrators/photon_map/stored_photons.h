// Photons that are traced once and stay, with the structure that looks them up.
#pragma once

#include "core/photons/photon_map.h"
#include "core/render/render_session.h"
#include "integrators/photon_paths/photon_paths_host.h"

#include <memory>

namespace lampyris {

class StoredPhotons {
 public:
    // `keep`: kernel::SPPM_KEEP_*. `stream` tells apart the random numbers of maps. Compiles what building and gathering need.
    StoredPhotons(RenderSession& session, uint32_t keep, uint32_t paths, uint32_t stream,
                  const PhotonConsumer& consumer);

    // Traces the paths, once. `parameters`: kernel::PhotonPathParams. Throws InputError where keys do not reach.
    void trace(const BufferHandle& parameters);

    // Hands the consumer what `count` queries find, none with a radius above `radius`. Builds the structure where it is not built or
    // serves other queries or another pass only.
    void gather(const BufferHandle& queries, uint32_t count, float radius, uint64_t pass);

    uint32_t count() const { return stored_; }
    PhotonMap& map() { return *map_; }
    // Adds to the session's statistics.
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

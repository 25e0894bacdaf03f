#include "integrators/photon_map/stored_photons.h"

#include "core/base/error.h"
#include "integrators/photon_paths/photon_host.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <bit>

namespace lampyris {

StoredPhotons::StoredPhotons(RenderSession& session, uint32_t keep, uint32_t paths, uint32_t stream,
                             const PhotonConsumer& consumer)
    : session_(session),
      paths_(paths),
      kernel_(session.device.compile(photon_files::kPhotons, session.scene.effects.mask())),
      map_(create_photon_map(session.photon_map)),
      consumer_(consumer) {
    map_->open(session.device);
    map_->prepare(consumer_);
    const glm::vec4 bounds = session.scene.record.bounds;
    // Slightly larger than the bounding sphere, because points on it belong to the scene.
    const glm::vec3 extent = bounds.w * 1.001f + 1e-6f * glm::abs(glm::vec3(bounds));
    pass_.low = glm::vec4(glm::vec3(bounds) - extent, 0.0f);
    pass_.high = glm::vec4(glm::vec3(bounds) + extent, 0.0f);
    pass_.number = stream;
    pass_.seed = session.seed;
    pass_.paths = paths;
    pass_.sampler_kind = session.sampler;
    pass_.points = 1;
    pass_.part_paths = paths;
    pass_.keep = keep;
}

// All photons are kept: if they do not fit, they are traced again into a store of the required size. A path is a
// function of its number and the seed, so their number is the same again.
void StoredPhotons::trace(const BufferHandle& parameters) {
    const BufferHandle arguments = session_.device.create_buffer(sizeof pass_, "pass");
    const BufferHandle counters = session_.device.create_buffer(sizeof(PhotonCounters), "counters");
    uint64_t capacity = std::min<uint64_t>(std::max<uint64_t>(4 * uint64_t(paths_), 65536), 1u << 30);
    for (;;) {
        store_.reset();
        store_ = session_.device.create_buffer(capacity * sizeof(kernel::PhotonRecord), "photons");
        pass_.capacity = uint32_t(capacity);
        arguments->upload(&pass_, sizeof pass_);
        counters->fill_zero();
        run_in_phase(session_, photon_files::kPhotons, *kernel_, "photon_tracing",
                     {{"passes", arguments}, {"params", parameters}, {"photons", store_}, {"counters", counters}},
                     paths_);
        const PhotonCounters found = download_photon_counters(*counters);
        stored_ = found[kernel::PHOTONS_STORED];
        session_.photons.rays += found[kernel::PHOTON_RAYS];
        if (const uint32_t most = found[kernel::PHOTONS_MOST_KEPT]; !keys_reach(paths_, most))
            throw InputError(
                fmt::format("error: a path stores up to {} photons, at masked surfaces and others, and {} times the "
                            "number of paths ({}) is more than 2^32; use fewer photons",
                            most, most, paths_));
        if (stored_ <= capacity) break;
        capacity = stored_;
    }
    session_.photons.emitted += paths_;
    session_.photons.stored += stored_;
}

void StoredPhotons::gather(const BufferHandle& queries, uint32_t count, float radius, uint64_t pass) {
    if (stored_ == 0) return;
    const PhotonMapCapabilities can = map_->capabilities();
    // Structures over the hit points depend on these. Structures that select photons at random are built in each pass,
    // so that the noise of the selection averages out.
    if (!built_ || can.needs_queries || (!can.exact && built_for_ != pass)) build(queries, count, radius, pass);
    map_->gather(consumer_, queries, 0, count);
}

void StoredPhotons::build(const BufferHandle& queries, uint32_t count, float radius, uint64_t pass) {
    PhotonSet set;
    set.photons = store_;
    set.count = stored_;
    set.queries = queries;
    set.query_count = count;
    set.radius = radius;
    set.low = glm::vec3(pass_.low);
    set.high = glm::vec3(pass_.high);
    set.seed = session_.seed;
    set.pass = map_->capabilities().exact ? 0 : uint32_t(pass);
    set.mean_power = session_.scene.record.light_power / float(paths_);
    map_->build(set);
    built_ = true;
    built_for_ = pass;
}

void StoredPhotons::finish() const {
    add_map_statistics(session_, *map_);
    if (!built_) return;
    PhotonStatistics& photons = session_.photons;
    if (const auto load = map_->bucket_load())
        photons.bucket_load_mean = load->mean, photons.bucket_load_max = load->max;
}

}  // namespace lampyris

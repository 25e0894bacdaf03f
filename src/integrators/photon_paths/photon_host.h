// Host steps of all photon-mapping integrators: timing kernels by phase, reading counters back, filling in statistics.
#pragma once

#include "core/photons/photon_map.h"
#include "core/render/render_session.h"
#include "integrators/photon_paths/photon_paths_host.h"

#include <array>
#include <span>

namespace lampyris {

// The kernels, and the consumer of the photons that hit points find.
namespace photon_files {
inline constexpr const char* kEye = "integrators/photon_paths/eye_pass.kernel.h";
inline constexpr const char* kRadius = "integrators/photon_paths/hit_radius.kernel.h";
inline constexpr const char* kPhotons = "integrators/photon_paths/photon_pass.kernel.h";
inline constexpr const char* kDirect = "integrators/photon_paths/hit_direct_light.kernel.h";
inline constexpr const char* kResolve = "integrators/photon_paths/hit_resolve.kernel.h";
inline constexpr const char* kConsumer = "integrators/photon_paths/hit_flux.consumer.h";
}  // namespace photon_files

using PhotonCounters = std::array<uint32_t, kernel::PHOTON_COUNTERS>;

// Runs a kernel over [0, count), and adds its time (by timestamps, on Vulkan) to a phase. `file` is the kernel's file.
void run_in_phase(RenderSession& session, const char* file, const Kernel& kernel, const char* phase,
                  std::initializer_list<NamedBuffer> buffers, uint32_t count);

PhotonCounters download_photon_counters(const Buffer& counters);

// Whether keys are unique (photon_key) if no path leaves more than `most` photons.
constexpr bool keys_reach(uint32_t paths, uint32_t most) { return uint64_t(paths) * most <= uint64_t(1) << 32; }

// Unpacks the box of the hit points, which hit_radius computed.
void unpack_box(const PhotonCounters& counters, kernel::PhotonPass& pass);

// Adds a map's times and sizes.
void add_map_statistics(RenderSession& session, const PhotonMap& map);

// Records the radii of `count` hit points in the last pass.
void note_radii(RenderSession& session, const Buffer& queries, const Buffer& hits, size_t count);

}  // namespace lampyris

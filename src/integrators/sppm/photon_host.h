// Host steps that all photon-mapping integrators take: kernels timed by phase, counters read back, statistics filled.
#pragma once

#include "core/photon_map.h"
#include "core/render_session.h"
#include "integrators/sppm/sppm_host.h"

#include <array>
#include <span>

namespace lampyris {

using SppmCounters = std::array<uint32_t, kernel::SPPM_COUNTERS>;

// Runs a kernel over [0, count), and adds what it took (by timestamps, on Vulkan) to a phase. `file` is the kernel's.
void run_in_phase(RenderSession& session, const char* file, const Kernel& kernel, const char* phase,
                  std::span<const BufferHandle> buffers, uint32_t count);

SppmCounters download_sppm_counters(const Buffer& counters);

// The box of the hit points, which sppm_radius found.
void unpack_box(const SppmCounters& counters, kernel::SppmPass& pass);

// Adds what a map took and how large it is.
void add_map_statistics(RenderSession& session, const PhotonMap& map);

// The radii of the last pass, of `count` hit points.
void note_radii(RenderSession& session, const Buffer& queries, const Buffer& hits, size_t count);

}  // namespace lampyris

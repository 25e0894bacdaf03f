// Counts of light paths and connections that suit a scene.
#pragma once

#include "core/render/render_session.h"
#include "integrators/bidirectional/bidirectional.h"

namespace lampyris {

// `options` with the counts, and whether to merge, that a pilot rendering finds to be the most efficient (Grittmann and others 2022,
// "Efficiency-aware multiple importance sampling for bidirectional rendering algorithms", by another estimator). `lightpaths` that are
// given stay, and `connections` while there are light paths. The choice depends on scene, resolution, seed and sampler: not on the
// crop, the passes, the backend's threads or the time. It is added to the session's choices. Throws InputError, MachineError.
BidirectionalOptions choose_counts(RenderSession& session, const BidirectionalOptions& options);

}  // namespace lampyris

// Progressive photon mapping: the schedule that `sppm` and `ppm` share.
#pragma once

#include "core/photons/photon_map.h"
#include "core/render/integrator.h"
#include "integrators/photon_paths/progressive_params.h"

namespace lampyris {

// Squared radius of pass `pass` (from 0) over that of the first one: the product over k = 1 ... pass of (k + alpha) / (k + 1)
// (Knaus and Zwicker 2011, equation 18).
double memoryless_scale(uint64_t pass, double alpha);

// Renders until the session's budget is spent. With `eye_samples` 0, each pass follows a new eye path per pixel (sppm).
// Else that number of eye paths per pixel is followed once, and their hit points and statistics stay (ppm). Throws
// InputError, MachineError.
void render_progressive(RenderSession& session, const ProgressiveParams& params, uint32_t eye_samples);

}  // namespace lampyris

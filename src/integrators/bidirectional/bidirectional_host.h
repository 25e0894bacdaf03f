// Host part that bidirectional methods share: the records of their kernels, and splats.
#pragma once

#include "core/device/kernel_types.h"
#include "core/scene/scene.h"

namespace lampyris {
namespace kernel {
#define CONST inline constexpr
#include "core/kernel/splat_layout.h"
#include "integrators/bidirectional/bidirectional_layout.h"
#undef CONST
}  // namespace kernel

// The unit of splats: 2^-24 of the radiance that a diffuse surface on the scene's bounding sphere shows if it receives the
// lights' whole power. 64 bits hold 5e11 times that.
float splat_quantum(const Scene& scene);

// The density, per pixel, of the film points of a pixel's camera rays: above 1 if the pixel filter is narrower than a pixel.
float film_density(const Scene& scene);

// Bytes of the splats of a film's pixels. Throws InputError if kernels cannot number them.
size_t splat_bytes(uint32_t pixels, const char* integrator);

}  // namespace lampyris

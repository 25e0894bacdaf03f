// What a radiance function sees. A file NAME.radiance.h defines
//     FN Spectrum radiance_along(IN(Ray) ray, INOUT(Sampler) numbers, INOUT(FirstHit) first)
// the radiance that arrives at the camera along a ray (W/(m^2 sr), linear Rec. 709), and is a kernel: the build completes it with
// core/kernel/pixel_loop.h, which has camera, film and loops. Random numbers begin at dimension CAMERA_DIMENSIONS. The
// function's parameters are the buffer of binding 1; the host's part is render_samples (core/render/integrator.h).
#ifndef LAMPYRIS_KERNEL_RADIANCE
#define LAMPYRIS_KERNEL_RADIANCE

#include "core/kernel/scene.h"
#include "core/kernel/film.h"

#endif

// What radiance functions include. A file NAME.radiance.h defines
//     FN Spectrum radiance_along(IN(Ray) ray, INOUT(Sampler) numbers, INOUT(FirstHit) first)
// the radiance that arrives at the camera along a ray (W/(m^2 sr), linear Rec. 709). The build completes it to a kernel with
// core/kernel/pixel_loop.h, which has camera, film and loops. Random numbers begin at dimension CAMERA_DIMENSIONS. The
// integrator's parameters are the buffer at binding 1; REGISTER_RADIANCE (core/render/integrator.h) is the host part.
#ifndef LAMPYRIS_KERNEL_RADIANCE
#define LAMPYRIS_KERNEL_RADIANCE

#include "core/kernel/scene.h"
#include "core/kernel/film.h"

#endif

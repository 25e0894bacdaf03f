// Parameters of progressive photon mapping: `ppm` and `sppm` share them.
#ifndef LAMPYRIS_PARAMS
#define LAMPYRIS_PARAMS

#include "core/kernel/params.h"

#define PROGRESSIVE_PARAMS(P)                                                                                          \
    P(int, maxdepth, 5, 0, 100000, "most scattering vertices of an eye path, and of a photon's path")                  \
    P(int, rrdepth, 1, 0, 100000, "vertices after which Russian roulette may end an eye path")                         \
    P(int, photonsperiteration, -1, -1, 1000000000,                                                                    \
      "paths emitted in each pass; -1: as many as the picture has pixels")                                             \
    P(float, radius, 0, 0, 1e30f, "radius of the first pass, in scene units; 0: `footprint` pixels at each hit point") \
    P(float, footprint, 3, 0.1f, 1000, "radius of the first pass if `radius` is 0, in widths of a pixel")              \
    P(float, minradius, 1e-6f, 0, 1, "radii stay above this share of the scene's radius")                              \
    P(float, alpha, 0.6666667f, 0.01f, 1, "share of the new photons that a pass keeps: how slowly radii shrink")       \
    P(uint, schedule, 0, 0, 1,                                                                                         \
      "{shared|memoryless} radii shrink with the photons that a pixel found (Hachisuka and Jensen 2009), or depend "   \
      "only on the number of the pass (Knaus and Zwicker 2011), so that passes are independent")                       \
    P(uint, direct, 0, 0, 1,                                                                                           \
      "{nee|photons} light that arrives without a bounce is found by sampling lights, or by photons")                  \
    P(float, glossy, 0.1f, 0, 1, "GGX alpha below which eye paths follow a reflection and photons are not stored")     \
    P(float, confidence, 0.9f, 0.5f, 0.999999f,                                                                        \
      "of the image's channel `error`: the probability that bias and noise stay below it where radiance is smooth")    \
    P(int, store, 0, 0, 1000000000,                                                                                    \
      "photons stored at once; if there are more, they are gathered in parts; 0: four per path")
PARAMS(ProgressiveParams, PROGRESSIVE_PARAMS)

#endif

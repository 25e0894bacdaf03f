// Parameters of classic photon mapping.
#ifndef LAMPYRIS_PHOTON_MAP_PARAMS
#define LAMPYRIS_PHOTON_MAP_PARAMS

#include "core/kernel/params.h"

#define PHOTON_MAP_PARAMS(P)                                                                                           \
    P(int, maxdepth, 5, 0, 100000, "most scattering vertices of an eye path, and of a photon's path")                  \
    P(int, rrdepth, 1, 0, 100000, "vertices after which Russian roulette may end an eye path")                         \
    P(int, photons, 1000000, 1, 1000000000, "photon paths, emitted once")                                              \
    P(float, radius, 0, 0, 1e30f,                                                                                      \
      "radius of every look-up, in scene units; 0: large enough for 50 photons (or four times `nearest`, if that is "  \
      "more) if they were spread evenly over the scene's bounding sphere")                                             \
    P(int, nearest, 0, 0, 256,                                                                                         \
      "number of nearest photons within `radius` that a look-up uses, over the disk that they fill; 0: all within "    \
      "`radius`")                                                                                                      \
    P(int, gather, 0, 0, 65536,                                                                                        \
      "final gathering: rays from each hit point in a pass; the map is looked up where they end; 0: the map is shown " \
      "directly")                                                                                                      \
    P(int, causticphotons, 0, 0, 1000000000,                                                                           \
      "with `gather`, paths emitted for the map of caustics; 0: as many as `photons`")                                 \
    P(float, causticradius, 0, 0, 1e30f,                                                                               \
      "with `gather`, radius of look-ups in the map of caustics, in scene units; 0: the radius of the other look-ups") \
    P(float, minradius, 1e-6f, 0, 1, "radii stay above this share of the scene's radius")                              \
    P(uint, direct, 0, 0, 1,                                                                                           \
      "{nee|photons} light that arrives without a bounce is found by sampling lights, or by photons")                  \
    P(float, glossy, 0.1f, 0, 1, "GGX alpha below which eye paths follow a reflection and photons are not stored")
PARAMS(PhotonMapParams, PHOTON_MAP_PARAMS)

#endif

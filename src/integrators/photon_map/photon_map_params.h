// Parameters of classic photon mapping.
#ifndef LAMPYRIS_PHOTON_MAP_PARAMS
#define LAMPYRIS_PHOTON_MAP_PARAMS

#include "core/kernel/params.h"

#define PHOTON_MAP_PARAMS(P)                                                                                           \
    P(int, maxdepth, 5, 0, 100000, "most scattering vertices of an eye path, and of a photon's path")                  \
    P(int, rrdepth, 1, 0, 100000, "vertices after which Russian roulette may end an eye path")                         \
    P(int, photons, 1000000, 1, 1000000000, "paths emitted, once")                                                     \
    P(float, radius, 0, 0, 1e30f,                                                                                      \
      "radius of every look-up, in scene units; 0: that in which 50 photons, or four times `nearest` where that is "   \
      "more, lie on average if they lay evenly on the scene's bounding sphere")                                        \
    P(int, nearest, 0, 0, 256,                                                                                         \
      "photons of a look-up: the nearest ones within `radius`, over the disk that they fill; 0: all within `radius`")  \
    P(int, gather, 0, 0, 65536,                                                                                        \
      "final gathering: rays that each hit point sends out in a pass, at whose ends the map is looked up; 0: the map " \
      "is shown directly")                                                                                             \
    P(int, causticphotons, 0, 0, 1000000000,                                                                           \
      "with `gather`, paths emitted for the map of caustics; 0: as many as `photons`")                                 \
    P(float, causticradius, 0, 0, 1e30f,                                                                               \
      "with `gather`, radius of look-ups of caustics, in scene units; 0: that of the others")                          \
    P(float, minradius, 1e-6f, 0, 1, "radii stay above this share of the scene's radius")                              \
    P(uint, direct, 0, 0, 1,                                                                                           \
      "{nee|photons} light that arrives without a bounce is found by sampling lights, or by photons")                  \
    P(float, glossy, 0.1f, 0, 1, "GGX alpha below which eye paths follow a reflection and photons are not kept")
PARAMS(PhotonMapParams, PHOTON_MAP_PARAMS)

#endif

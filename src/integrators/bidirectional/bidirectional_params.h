// Parameters that bidirectional methods share.
#ifndef LAMPYRIS_BIDIRECTIONAL_PARAMS
#define LAMPYRIS_BIDIRECTIONAL_PARAMS

#include "core/kernel/params.h"

#define SUBPATH_PARAMS(P)                                                                                   \
    P(int, maxdepth, 5, 0, 60000, "most scattering vertices of a path, specular ones included")             \
    P(int, rrdepth, 3, 0, 100000, "vertices after which Russian roulette may end a path, from either side") \
    P(int, lightpaths, -1, -1, 1000000000, "paths from lights in each pass; -1 or 0: as many as the picture has pixels")

#define CONNECTION_PARAMS(P)                                                                                        \
    P(int, connections, -1, -1, 60000,                                                                              \
      "vertices of a light path to which each vertex of a camera path is connected, chosen at random; -1: all; 0: " \
      "none, and weights know it")                                                                                  \
    P(int, cache, 0, 0, 64,                                                                                         \
      "light paths, chosen at random among all, to which each vertex of a camera path is connected at each depth "  \
      "(light vertex cache); 0: the vertices of one light path, for the whole camera path")

#define COUNTS_PARAMS(P)                                                                                             \
    P(uint, counts, 0, 0, 1,                                                                                         \
      "{fixed|auto} auto: of light paths, connections and merging, a pilot rendering chooses what suits the scene; " \
      "`lightpaths` that are given stay, and `connections` while there are light paths")

#define MERGING_PARAMS(P)                                                                                           \
    P(float, radius, 0, 0, 1e30f, "of merging in the first pass, in scene units; 0: `share` of the scene's radius") \
    P(float, share, 0.003f, 1e-6f, 1, "radius of merging in the first pass over that of the scene")                 \
    P(float, alpha, 0.75f, 0.01f, 1, "how slowly the radius shrinks: radius^2 falls as pass^(alpha - 1)")

#endif

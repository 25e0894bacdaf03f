// Parameters of bidirectional path tracing.
#ifndef LAMPYRIS_BDPT_PARAMS
#define LAMPYRIS_BDPT_PARAMS

#include "core/kernel/params.h"

#define BDPT_PARAMS(P)                                                                                                 \
    P(int, maxdepth, 5, 0, 60000, "most scattering vertices of a path, specular ones included")                        \
    P(int, rrdepth, 3, 0, 100000, "vertices after which Russian roulette may end a path, from either side")            \
    P(int, lightpaths, -1, -1, 1000000000,                                                                             \
      "paths from lights in each pass; -1 or 0: as many as the picture has pixels")                                    \
    P(int, connections, -1, -1, 60000,                                                                                 \
      "vertices of a light path to which each vertex of a camera path is connected, chosen at random; -1: all; 0: "    \
      "none, and weights know it")                                                                                     \
    P(uint, weights, 0, 0, 2,                                                                                          \
      "{balance|power|none} heuristic that weighs the strategies; none shows each as if it were alone: for one of "    \
      "them, chosen by the next two")                                                                                  \
    P(int, s, -1, -1, 100000, "only strategies with so many vertices from the light; -1: any")                         \
    P(int, t, -1, -1, 100000, "only strategies with so many vertices from the camera; -1: any")                        \
    P(uint, strategies, 0, 0, 1,                                                                                       \
      "{off|on} also keeps images of each strategy, weighed and alone, as layers strategy.s1t3 and alone.s1t3 of the " \
      "image: "                                                                                                        \
      "each takes the passes once more")
PARAMS(BdptParams, BDPT_PARAMS)

#endif

// Parameters of Metropolis light transport.
#ifndef LAMPYRIS_MLT_PARAMS
#define LAMPYRIS_MLT_PARAMS

#include "core/kernel/params.h"

#define MLT_PARAMS(P)                                                                                            \
    P(int, maxdepth, 5, 0, 1000, "most scattering vertices of a path, specular ones included")                   \
    P(int, mutationsperpixel, 8, 1, 1000000, "mutations in each pass, for each pixel of the picture")            \
    P(int, bootstrapsamples, -1, -1, 100000000,                                                                  \
      "independent paths in each pass, from which chains start and by which the picture's brightness is known; " \
      "-1: a fourth of the mutations, at least 16384")                                                           \
    P(int, chains, -1, -1, 10000000,                                                                             \
      "chains in each pass, at most as many as mutations; -1: for a hundred mutations each, 1024 to 65536")      \
    P(float, largestepprobability, 0.3f, 0, 1, "of a mutation that is independent of the current path")          \
    P(float, sigma, 0.01f, 1e-7f, 1, "standard deviation of the other mutations, of numbers between 0 and 1")    \
    P(int, direct, 4, 1, 4096, "samples of a pixel in each pass, for light that scatters at most once")          \
    P(uint, weights, 0, 0, 1, "{balance|power} heuristic that weighs the strategies of a path")
PARAMS(MltParams, MLT_PARAMS)

#endif

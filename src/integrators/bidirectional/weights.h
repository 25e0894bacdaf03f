// Weights as the pass asks for them. The kernel declares `passes`.
#ifndef LAMPYRIS_WEIGHTS
#define LAMPYRIS_WEIGHTS

#include "integrators/bidirectional/bidirectional_layout.h"
#include "integrators/bidirectional/mis.h"

FN uint heuristic() { return passes[0].weights == WEIGHTS_POWER ? HEURISTIC_POWER : HEURISTIC_BALANCE; }

// Areas in units of the squared radius of the scene: for all densities that enter weights.
FN float mis_area(float area) { return area / sqr(scene[0].bounds.w); }
FN float mis_area_density(float density) { return density * sqr(scene[0].bounds.w); }

// The weight of a strategy from the sum of the others' densities over its own.
FN float mis_weight(float others) { return passes[0].weights == WEIGHTS_NONE ? 1.0f : 1.0f / (1.0f + others); }

// Light paths that may reach a pixel, over its camera rays: the density of strategies t = 1 has this factor.
FN float lens_samples() { return float(passes[0].paths) / passes[0].film_density; }

// How often a camera path is connected to a light path's vertex by each strategy that does so: their densities have this factor.
FN float connection_samples() { return mis_term(passes[0].samples, heuristic()); }

FN bool strategy_wanted(int from_light, int from_camera) {
    int s = passes[0].only_light;
    int t = passes[0].only_camera;
    return (s < 0 || s == from_light) && (t < 0 || t == from_camera);
}

#endif

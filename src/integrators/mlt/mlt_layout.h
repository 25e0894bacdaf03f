// What the kernels of Metropolis light transport share.
#ifndef LAMPYRIS_MLT_LAYOUT
#define LAMPYRIS_MLT_LAYOUT

// One run of the kernel.
struct MltPass {
    uint mode;        // MLT_*
    uint seed;        // of the pass
    uint iterations;  // mutations of each chain in this run
    uint first;       // number of the first one
    uint chains;
    uint depths;       // numbers of scattering vertices, from MLT_LEAST_DEPTH on
    float sigma;       // standard deviation of small steps
    float large_step;  // probability
    float quantum;     // of splats
    float brightness;  // luminance of the picture over the number of mutations for each pixel, for mlt_pixels
    uint samples;      // of each pixel for direct light, for mlt_pixels
    uint unused;
};

CONST uint MLT_SEEDS = 0u;   // finds the luminance of independent paths
CONST uint MLT_START = 1u;   // begins chains at chosen ones of these
CONST uint MLT_MUTATE = 2u;  // goes on with the chains

// Shorter paths are sampled independently, because next-event estimation finds them well.
CONST int MLT_LEAST_DEPTH = 2;

// The current path of a chain.
struct MltState {
    vec3 color;       // of MltSample, over its luminance
    float luminance;  // 0: no path
    vec2 raster;
    float weight;  // not yet splatted
    uint kind;     // scattering vertices, and MltSample's one_pixel << 16
};

// Words of `counters`.
CONST uint MLT_RAYS = 0u;
CONST uint MLT_LARGE_STEPS = 1u;
CONST uint MLT_LARGE_ACCEPTED = 2u;
CONST uint MLT_SMALL_ACCEPTED = 3u;
CONST uint MLT_COUNTERS = 4u;

// ---- Numbers of a path -----------------------------------------------------------------------------------------------

CONST uint MLT_STRATEGY = 0u;
CONST uint MLT_RASTER = 1u;
CONST uint MLT_LENS = 3u;
CONST uint MLT_EMISSION = 5u;     // light, side, place, direction
CONST uint MLT_CONNECTION = 11u;  // light, point
CONST uint MLT_VERTICES = 14u;
CONST uint MLT_VERTEX_NUMBERS =
    3u;  // lobe, direction: the camera's vertices from the first on, the light's from the last on

#endif

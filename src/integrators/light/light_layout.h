// What the kernels of light tracing share.
#ifndef LAMPYRIS_LIGHT_LAYOUT
#define LAMPYRIS_LIGHT_LAYOUT

struct LightPass {
    uint number;
    uint seed;
    uint sampler_kind;  // SAMPLER_*
    uint paths;         // from lights, in the pass
    int maxdepth;
    float quantum;     // of splats (splat.h), in units of radiance
    float brightness;  // a splat times this is about the radiance of a pixel: what the sensor's clamp compares
    uint unused;
};

#endif

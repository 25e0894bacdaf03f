// What a query found (collect.consumer.h).
#ifndef LAMPYRIS_COLLECT_LAYOUT
#define LAMPYRIS_COLLECT_LAYOUT

struct CollectResult {
    vec4 sum;     // weighted power; w: sum of the weights
    uvec4 found;  // x: photons, y: sum of their keys' hash32
};

#endif

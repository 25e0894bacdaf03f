// The result of a query, as collect.consumer.h writes it; collect_nearest.consumer.h gives the fields other meanings.
#ifndef LAMPYRIS_COLLECT_LAYOUT
#define LAMPYRIS_COLLECT_LAYOUT

struct CollectResult {
    vec4 sum;     // weighted power; w: sum of the weights
    uvec4 found;  // x: number of photons, y: sum of their keys' hash32
};

#endif

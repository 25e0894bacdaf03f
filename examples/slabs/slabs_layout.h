// What host and kernels share: all kernels get this record in a buffer.
#ifndef SLABS_LAYOUT
#define SLABS_LAYOUT

struct Slabs {
    float low;    // where the first slab begins
    float scale;  // slabs per scene unit
    uint slabs;
    uint photons;
};

#endif

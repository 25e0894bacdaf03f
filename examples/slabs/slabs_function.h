// The slab of a coordinate.
#ifndef SLABS_FUNCTION
#define SLABS_FUNCTION

#include "core/kernel/photon.h"
#include "slabs/slabs_layout.h"

// Never falls when z rises, whatever is rounded: a photon between two coordinates lies in a slab between theirs.
FN uint slab_of(IN(Slabs) s, float z) {
    float place = (z - s.low) * s.scale;
    return place > 0.0f ? uint(min(place, float(s.slabs - 1u))) : 0u;
}

#endif

// Primary sample space: a path is a vector of numbers, which small and large steps mutate (Kelemen, Szirmay-Kalos, Antal and
// Csonka 2002, "A Simple and Robust Mutation Strategy for the Metropolis Light Transport Algorithm"). Small steps are normally
// distributed, as pbrt-v4's.
//
// Numbers are integers of 32 bits, so that steps wrap around exactly. A mutation is a function of (chain, iteration, number): it
// is computed when the path needs it, and again when it is accepted.
#ifndef LAMPYRIS_MLT_NUMBERS
#define LAMPYRIS_MLT_NUMBERS

BUFFER_RW(6, uint, numbers)  // of all chains: those of one dimension are neighbours

PRIVATE(uint, primary_key, 1)    // of the proposal
PRIVATE(uint, primary_large, 1)  // 1: the proposal is independent of the current path
PRIVATE(uint, primary_chain, 1)

// Numbers of a path with that many scattering vertices.
FN uint mlt_dimensions(uint depth) { return MLT_VERTICES + MLT_VERTEX_NUMBERS * depth; }

FN uint primary_bits(uint dimension) {
    uvec3 bits = pcg3d(uvec3(primary_key[0], dimension, 0x2c1b3c6du));
    if (primary_large[0] != 0u) return bits.x;
    // Box and Muller 1958.
    float across = cos_of(TWO_PI * unit_float(bits.y));
    float size = mlt[0].sigma * sqrt(-2.0f * log_of(1.0f - unit_float(bits.x))) * abs(across);
    uint step = uint((size - floor(size)) * 4294967040.0f);
    uint current = numbers[dimension * mlt[0].chains + primary_chain[0]];
    return across > 0.0f ? current + step : current - step;
}

FN float primary(uint dimension) { return unit_float(primary_bits(dimension)); }
FN vec2 primary_2d(uint dimension) { return vec2(primary(dimension), primary(dimension + 1u)); }
FN uvec2 primary_bits_2d(uint dimension) { return uvec2(primary_bits(dimension), primary_bits(dimension + 1u)); }

// Makes the proposal the current path.
FN void primary_accept(uint dimensions) {
    for (uint d = 0u; d < dimensions; ++d) numbers[d * mlt[0].chains + primary_chain[0]] = primary_bits(d);
}

#endif

// Counter-based random numbers: every number is a function of (seed, pixel, sample, dimension), so that an image does not
// depend on threads or order, and a pixel can be replayed alone, on either backend.
#ifndef LAMPYRIS_KERNEL_RANDOM
#define LAMPYRIS_KERNEL_RANDOM

// Integer hash with low bias (C. Wellons, "Prospecting for hash functions", 2018: lowbias32).
FN uint hash32(uint x) {
    x ^= x >> 16u;
    x *= 0x7feb352du;
    x ^= x >> 15u;
    x *= 0x846ca68bu;
    x ^= x >> 16u;
    return x;
}
FN uint hash_combine(uint a, uint b) { return hash32(a ^ (b * 0x9e3779b9u + 0x7f4a7c15u + (a << 6u) + (a >> 2u))); }

// Hashes three words to three words (Jarzynski and Olano 2020, "Hash Functions for GPU Rendering": pcg3d).
FN uvec3 pcg3d(uvec3 v) {
    v = v * 1664525u + uvec3(1013904223u);
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.x ^= v.x >> 16u;
    v.y ^= v.y >> 16u;
    v.z ^= v.z >> 16u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

// A number in [0, 1) from the upper 24 bits.
FN float unit_float(uint bits) { return float(bits >> 8u) * 5.9604644775390625e-8f; }
FN vec2 unit_floats(uvec2 bits) { return vec2(unit_float(bits.x), unit_float(bits.y)); }

// Rounds a probability in [0, 1] up to the probability that `u < chance` has for a unit_float u: whatever is weighted
// by its inverse must be kept exactly that often, however small it is.
FN float exact_chance(float chance) { return ceil(chance * 16777216.0f) * 5.9604644775390625e-8f; }

// Owen scrambling of bit-reversed numbers by hashing (Laine and Karras 2011, constants by Vegdahl 2021; used as in Burley
// 2020, "Practical Hash-based Owen Scrambling").
FN uint scramble_reversed(uint x, uint seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16u) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

// The second Sobol dimension's generator matrix is Pascal's triangle mod 2, a five-fold tensor power of (1 1; 0 1): five
// steps instead of 32. The result is bit-reversed.
FN uint sobol_second_reversed(uint x) {
    x ^= (x & 0xaaaaaaaau) >> 1u;
    x ^= (x & 0xccccccccu) >> 2u;
    x ^= (x & 0xf0f0f0f0u) >> 4u;
    x ^= (x & 0xff00ff00u) >> 8u;
    x ^= (x & 0xffff0000u) >> 16u;
    return x;
}

struct Sampler {
    uint key;        // hash of seed and pixel
    uint reversed;   // the sample's index, with its bits reversed
    uint index;      // of the sample
    uint dimension;  // of the next number
    uint kind;
};

FN Sampler sampler_begin(uint pixel, uint sample_index, uint seed, uint kind) {
    Sampler s;
    s.key = hash_combine(hash32(seed + 0x68bc21ebu), pixel);
    s.reversed = bitfieldReverse(sample_index);
    s.index = sample_index;
    s.dimension = 0u;
    s.kind = kind;
    return s;
}

// Seeds of independent scramblings, from one seed that is already well mixed. They must be independent down to the
// lowest bit, which determines the highest bit of a number.
FN uint scramble_seed(uint seed, uint which) {
    uint mixed = (seed ^ (0xa511e9b3u + which * 0xbea24c72u)) * 0x9e3779b1u;
    return mixed ^ (mixed >> 15u);
}

// Scrambles the numbers of a point, given with reversed bits.
FN uvec2 scrambled_point(uvec2 reversed, uint seed) {
    uint x = scramble_reversed(reversed.x, scramble_seed(seed, 0u));
    uint y = scramble_reversed(reversed.y, scramble_seed(seed, 1u));
    return bitfieldReverse(uvec2(x, y));
}

FN uvec2 independent_2d(IN(Sampler) s, uint dimension) {
    uvec3 bits = pcg3d(uvec3(s.key, s.index, dimension));
    return uvec2(bits.x, bits.y);
}

// The number of a dimension, for callers that skip numbers that they do not need: a dimension has the same meaning in
// every sample. The 32 bits are for choices among many (distribution.h); the functions that return numbers in [0, 1)
// return the same numbers.
FN uint sample_bits_1d_at(IN(Sampler) s, uint dimension) {
    if (s.kind == SAMPLER_INDEPENDENT) return independent_2d(s, dimension).x;
    uint seed = hash_combine(s.key, dimension);
    uint shuffled = bitfieldReverse(scramble_reversed(s.reversed, seed));
    return bitfieldReverse(scramble_reversed(shuffled, scramble_seed(seed, 0u)));
}

FN uvec2 sample_bits_2d_at(IN(Sampler) s, uint dimension) {
    if (s.kind == SAMPLER_INDEPENDENT) return independent_2d(s, dimension);
    uint seed = hash_combine(s.key, dimension);
    uint shuffled = bitfieldReverse(scramble_reversed(s.reversed, seed));
    return scrambled_point(uvec2(shuffled, sobol_second_reversed(shuffled)), seed);
}

FN float sample_1d_at(IN(Sampler) s, uint dimension) { return unit_float(sample_bits_1d_at(s, dimension)); }
FN vec2 sample_2d_at(IN(Sampler) s, uint dimension) { return unit_floats(sample_bits_2d_at(s, dimension)); }

// ---- Pairs of numbers that are stratified together -------------------------------------------------------------------

// The index of a group's Sobol point. Pairs that are shuffled at random are each stratified, but what depends on two of
// them together is not sampled better than at random. Here, a group's index is multiplied by a polynomial of its own,
// modulo 2, where z shifts to the right: (1 + z^a) (1 + z^b) (1 + z^c), with four bits each in the table. This maps every
// block of 2^k indices to one, so that each pair remains a (0, 2)-sequence. The polynomials were searched for the least
// variance of smooth functions of the pairs of neighbouring vertices (docs/decisions/joined-pairs.md).
CONST uint JOINED_GROUPS = 8u;
FN uint joined_index(uint index, uint group) {
    uint shifts = group < 4u ? (group < 2u ? 0x08110742u : 0x04310654u) : (group < 6u ? 0x07620753u : 0x08750632u);
    shifts >>= 16u * (group & 1u);
    index ^= index >> (shifts & 15u);
    index ^= index >> ((shifts >> 4u) & 15u);
    return index ^ (index >> ((shifts >> 8u) & 15u));
}

// The point of a (0, 2)-sequence in base 2 that is more even than a randomly scrambled one: these constants (a nested
// scrambling, as any product with an even number) were searched for the least error at edges in the square and in the
// disk, with 16, 64 and 256 points that are shifted at random (by exclusive or).
FN uvec2 even_point(uint index) {
    uint x = index;
    uint y = sobol_second_reversed(index);
    x ^= x * 0xa4abe382u;
    x ^= x * 0x29f88b10u;
    y ^= y * 0xfb07cf82u;
    y ^= y * 0x8e1451d0u;
    return bitfieldReverse(uvec2(x, y));
}

// Groups beyond the table are shuffled at random.
FN uvec2 joined_point(IN(Sampler) s, uint dimension, uint group) {
    if (group < JOINED_GROUPS) return even_point(joined_index(s.index, group));
    return even_point(bitfieldReverse(scramble_reversed(s.reversed, hash_combine(s.key, dimension))));
}

// Like sample_bits_2d_at, for pairs that are stratified together with those of other groups. Two pairs that an integrand
// depends on must not be of one group.
FN uvec2 sample_bits_joined_2d_at(IN(Sampler) s, uint dimension, uint group) {
    if (s.kind == SAMPLER_INDEPENDENT) return independent_2d(s, dimension);
    uvec3 shift = pcg3d(uvec3(s.key, 0x9e3779b9u, dimension));
    return joined_point(s, dimension, group) ^ uvec2(shift.x, shift.y);
}

// The bits of two pairs of numbers, (x, y) and (z, w), of one group, for integrands that are the sum of a function of one
// pair and a function of the other. Both pairs are the same point, shifted differently. Two separate points would be no
// better for such integrands. Uses the dimensions of two pairs.
FN uvec4 sample_bits_joined_2d_2d_at(IN(Sampler) s, uint dimension, uint group) {
    if (s.kind == SAMPLER_INDEPENDENT) {
        uvec2 a = independent_2d(s, dimension);
        uvec2 b = independent_2d(s, dimension + 2u);
        return uvec4(a.x, a.y, b.x, b.y);
    }
    uvec2 point = joined_point(s, dimension, group);
    uvec3 shift = pcg3d(uvec3(s.key, 0x9e3779b9u, dimension));
    return uvec4(point.x ^ shift.x, point.y ^ shift.y, point.x ^ shift.z, point.y ^ hash32(shift.z));
}

// The next number, at the sampler's current dimension.
FN float sample_1d(INOUT(Sampler) s) {
    s.dimension += 1u;
    return sample_1d_at(s, s.dimension - 1u);
}

FN vec2 sample_2d(INOUT(Sampler) s) {
    s.dimension += 2u;
    return sample_2d_at(s, s.dimension - 2u);
}

// A stream of independent numbers for inner random walks (layered coats), keyed by two words.
struct Rng {
    uint key;
    uint counter;
};

FN Rng rng_begin(uint a, uint b) {
    Rng r;
    r.key = hash_combine(hash32(a), b);
    r.counter = 0u;
    return r;
}

FN uint rng_bits(INOUT(Rng) r) {
    r.counter += 1u;
    return hash32(r.key + r.counter * 0x9e3779b9u);
}
FN float rng_float(INOUT(Rng) r) { return unit_float(rng_bits(r)); }

#endif

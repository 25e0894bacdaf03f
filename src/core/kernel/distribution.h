// Discrete sampling in proportion to weights: of a light, or of a row and a texel of an infinite light's image.
//
// A CDF consists of integers from 0 to CDF_TOTAL (layout.h), so that the difference of an interval's two numbers is
// exactly the probability of choosing it, wherever it is in the CDF. Differences of floats lose intervals with a
// probability below 2^-24, and are inaccurate near that. Inverting a CDF keeps stratified numbers stratified, which an
// alias table does not (docs/decisions/integer-cdfs.md).
#ifndef LAMPYRIS_KERNEL_DISTRIBUTION
#define LAMPYRIS_KERNEL_DISTRIBUTION

// Rounds only once, and so equally on every device: conversions of integers below 2^24 are exact.
FN float float_of_uint(uint x) { return float(x >> 8u) * 256.0f + float(x & 0xffu); }

// 32 random bits as a number below CDF_TOTAL.
FN uint cdf_number(uint bits) { return bits >> 1u; }

// Finds the interval that contains `number` (below CDF_TOTAL) in a CDF of `count` intervals (count + 1 numbers in
// `distributions`).
FN uint find_interval(uint first, uint count, uint number) {
    // No branch on the comparison, because its result is unpredictable.
    uint low = 0u;
    uint size = count;
    while (size > 1u) {
        uint half_size = size >> 1u;
        low += half_size & (0u - uint(distributions[first + low + half_size] <= number));
        size -= half_size;
    }
    return low;
}

// The probability of the interval that begins at `at`.
FN float interval_share(uint at) {
    return float_of_uint(distributions[at + 1u] - distributions[at]) * 4.656612873077393e-10f;  // 1 / CDF_TOTAL
}

// The number's relative position in its interval, in [0, 1). `fraction`, in [0, 1), refines the number beyond its
// integer: in an interval of few integers, most of the position depends on it.
FN float place_in_interval(uint at, uint number, float fraction) {
    uint low = distributions[at];
    return min((float_of_uint(number - low) + fraction) / float_of_uint(distributions[at + 1u] - low),
               ONE_MINUS_EPSILON);
}

// A sample of a piecewise constant density on the unit square (layout.h, LightRecord.distribution): a texel, and a
// point of the square that is uniform within it.
struct TexelSample {
    uint x;
    uint y;
    vec2 st;
};

// The numbers that such a density has in `distributions`.
FN uint image_distribution_size(uint width, uint height) { return height + 1u + height * (width + 1u); }

FN TexelSample sample_image_distribution(uint offset, uint width, uint height, uvec2 bits) {
    uvec2 number = uvec2(cdf_number(bits.x), cdf_number(bits.y));
    TexelSample s;
    s.y = find_interval(offset, height, number.y);
    uint row = offset + height + 1u + s.y * (width + 1u);
    s.x = find_interval(row, width, number.x);
    // The fraction of each coordinate comes from the bits of the other one, which are random even if an interval has a
    // single integer.
    s.st = vec2((float(s.x) + place_in_interval(row + s.x, number.x, unit_float(hash32(bits.y)))) / float(width),
                (float(s.y) + place_in_interval(offset + s.y, number.y, unit_float(hash32(bits.x)))) / float(height));
    return s;
}
FN float pdf_image_texel(uint offset, uint width, uint height, uint x, uint y) {
    return interval_share(offset + height + 1u + y * (width + 1u) + x) * interval_share(offset + y) *
           (float(width) * float(height));
}

#endif

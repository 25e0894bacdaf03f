// Samples the CDFs of a scene: for a number, the interval; for the bits of two numbers, the texel and the position in it.
#include "core/kernel/prelude.h"
#ifndef __cplusplus
#include "core/kernel/effects.h"
#include "core/kernel/layout.h"
#include "core/kernel/scene_buffers.h"
#endif
#include "core/kernel/bindings.h"
#include "core/kernel/math.h"
#include "core/kernel/random.h"
#include "core/kernel/distribution.h"

struct DistributionProbe {
    uvec4 what;  // x: 0 intervals, 1 texels, 2 chances; offset; intervals, or width; height
};

BUFFER_RO(0, DistributionProbe, probe)
BUFFER_RO(1, uvec4, inputs)  // x: number; or x, y: bits; or a float's bits, and a number's
BUFFER_RW(2, uvec4,
          results)  // interval, bits of its share, of the place in it, -; or texel x, y, bits of its density, -,
BUFFER_RW(3, vec4, places)  // and the place on the square

KERNEL(distribution_probe) {
    uvec4 what = probe[0].what;
    uvec4 in_bits = inputs[index];
    if (what.x == 2u) {
        float chance = exact_chance(uintBitsToFloat(in_bits.x));
        results[index] = uvec4(floatBitsToUint(chance), unit_float(in_bits.y) < chance ? 1u : 0u, 0u, 0u);
        return;
    }
    if (what.x == 0u) {
        uint interval = find_interval(what.y, what.z, in_bits.x);
        float place = place_in_interval(what.y + interval, in_bits.x, 0.0f);
        results[index] =
            uvec4(interval, floatBitsToUint(interval_share(what.y + interval)), floatBitsToUint(place), 0u);
        return;
    }
    TexelSample s = sample_image_distribution(what.y, what.z, what.w, uvec2(in_bits.x, in_bits.y));
    results[index] = uvec4(s.x, s.y, floatBitsToUint(pdf_image_texel(what.y, what.z, what.w, s.x, s.y)), 0u);
    places[index] = vec4(s.st.x, s.st.y, 0.0f, 0.0f);
}

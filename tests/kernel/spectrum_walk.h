// A walk between metal plates through an absorbing medium: products, quotients, sums, functions of each value.
#include "core/kernel/prelude.h"
#include "core/kernel/effects.h"
#include "core/kernel/layout.h"
#include "core/kernel/math.h"
#include "core/kernel/spectrum.h"
#include "core/kernel/fresnel.h"

FN Spectrum spectrum_walk(Spectrum n, Spectrum k, Spectrum absorption, float cosine) {
    Spectrum throughput = Spectrum(1.0f);
    Spectrum radiance = Spectrum(0.0f);
    for (int depth = 0; depth < 3; ++depth) {
        Spectrum f = fresnel_conductor(cosine, n, k) / cosine;
        throughput *= f * cosine;
        throughput *= exp_of_minus(absorption * (0.5f + float(depth)));
        if (is_black(throughput)) break;
        radiance += throughput * 0.25f + 0.5f * throughput;
    }
    return clamp_each(radiance / (Spectrum(1.5f) - radiance), 0.0f, 0.9f);
}

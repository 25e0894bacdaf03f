// Tests whether the directions that a material samples follow a density: its own, or a wrong one.
#pragma once

#include "support/bsdf_probe.h"
#include "support/histogram.h"

namespace lampyris::test {

inline ChiSquaredResult chi_squared(BsdfProber& prober, const BsdfProbe& sampled, const BsdfProbe& density) {
    constexpr size_t kSamples = 100000;
    constexpr int kCellsZ = 20, kCellsPhi = 16, kSub = 14;
    Domain sphere = sphere_domain();
    Histogram histogram{kCellsZ, kCellsPhi};
    for (const ProbeSample& s : prober.sample(sampled, kSamples)) {
        if (s.found())
            histogram.add(sphere, s.wi_pdf);
        else
            histogram.miss();
    }
    auto expected = expected_counts(sphere, kCellsZ, kCellsPhi, kSub, kSamples, [&](const std::vector<vec4>& wi) {
        std::vector<double> values;
        for (vec4 f_pdf : prober.eval_at_wo(density, wi)) values.push_back(f_pdf.w);
        return values;
    });
    return chi_squared_test(histogram.cells, expected);
}

}  // namespace lampyris::test

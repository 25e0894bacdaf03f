// Two renderings with the same random numbers, of scenes that are the same except for rounding.
//
// Pixel differences are paired. If the paths are the same except for rounding, differences are tiny, and a few samples give the
// mean difference to many digits. If rounding changes a choice (a hash of a position), differences are noise, which shows in
// their spread over the pixels. A loss of light in a share f of n pixels is sqrt(n f) standard errors.
#pragma once

#include "support/render.h"

#include <cmath>
#include <string>

namespace lampyris::test {

struct Paired {
    double relative_difference = 0.0;  // of the means, over the first one's
    double standard_error = 0.0;       // likewise
    double mean = 0.0;                 // of the first one
};

// Luminance in the window [x0, x1) x [y0, y1).
inline Paired compare_paired(const Rendered& a, const Rendered& b, int x0, int y0, int x1, int y1) {
    const double n = double(x1 - x0) * double(y1 - y0);
    double mean = 0.0, sum = 0.0, squares = 0.0;
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
            const double difference = b.luminance(x, y) - a.luminance(x, y);
            mean += a.luminance(x, y) / n;
            sum += difference / n;
            squares += difference * difference / n;
        }
    if (mean == 0.0) return {sum == 0.0 ? 0.0 : INFINITY, 0.0, 0.0};
    return {sum / mean, std::sqrt(std::max(squares - sum * sum, 0.0) / n) / mean, mean};
}

inline Paired compare_paired(const Rendered& a, const Rendered& b) {
    return compare_paired(a, b, 0, 0, a.width, a.height);
}

}  // namespace lampyris::test

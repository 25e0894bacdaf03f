#include "support/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace lampyris::test {

// The regularised upper incomplete gamma function Q(dof/2, x/2): a series below its knee, else Lentz's continued fraction
// (Abramowitz and Stegun, 6.5.29 and 6.5.31).
double chi_squared_survival(double x, double dof) {
    double a = dof / 2, t = x / 2;
    if (!(t > 0)) return 1;
    double scale = std::exp(a * std::log(t) - t - std::lgamma(a));
    if (t < a + 1) {
        double term = 1 / a, sum = term;
        for (int n = 1; n < 10000 && term > sum * 1e-16; ++n) sum += term *= t / (a + n);
        return 1 - scale * sum;
    }
    double b = t + 1 - a, c = 1e300, d = 1 / b, h = d;
    for (int n = 1; n < 10000; ++n) {
        double an = -n * (n - a);
        b += 2;
        d = 1 / (an * d + b);
        c = b + an / c;
        double change = c * d;
        h *= change;
        if (std::abs(change - 1) < 1e-15) break;
    }
    return scale * h;
}

double normal_threshold(double p) {
    double low = 0, high = 40;
    for (int i = 0; i < 100; ++i) {
        double middle = (low + high) / 2;
        (std::erfc(middle / std::sqrt(2.0)) > p ? low : high) = middle;
    }
    return high;
}

ChiSquaredResult chi_squared_test(std::span<const double> observed, std::span<const double> expected) {
    ChiSquaredResult result;
    std::vector<size_t> order(expected.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::sort(order.begin(), order.end(), [&](size_t i, size_t j) { return expected[i] < expected[j]; });
    double pooled_observed = 0, pooled_expected = 0;
    auto add = [&](double o, double e) {
        result.statistic += (o - e) * (o - e) / e;
        ++result.dof;
    };
    for (size_t i : order) {
        pooled_observed += observed[i];
        pooled_expected += expected[i];
        if (pooled_expected < 5) continue;
        add(pooled_observed, pooled_expected);
        pooled_observed = pooled_expected = 0;
    }
    // If fewer than 5 counts are expected in all, they are tested by Markov's inequality with room to spare.
    if (pooled_observed > 50 + 20 * pooled_expected) {
        result.p = 0;
        result.impossible =
            std::to_string(pooled_observed) + " counts where " + std::to_string(pooled_expected) + " are expected";
        return result;
    }
    result.dof = std::max(result.dof - 1, 1);
    result.p = chi_squared_survival(result.statistic, result.dof);
    return result;
}

double Mean::error() const {
    return count_ > 1 ? std::sqrt(sum_ / double(count_ - 1) / double(count_)) : std::numeric_limits<double>::infinity();
}

}  // namespace lampyris::test

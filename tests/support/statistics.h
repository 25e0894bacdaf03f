// Hypothesis tests with stated false-alarm rates.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace lampyris::test {

// P(X > x) for X of the chi-squared distribution with `dof` degrees of freedom.
double chi_squared_survival(double x, double dof);

// |z| that a standard normal variable exceeds with probability p (two-sided).
double normal_threshold(double p);

struct ChiSquaredResult {
    double statistic = 0;
    int dof = 0;
    double p = 1;            // probability of a statistic at least this large if the expected counts are right
    std::string impossible;  // why p is 0 without a statistic: counts in cells where none are possible
};

// Pearson's test of counts. Cells that expect fewer than 5 are pooled. The expected counts are given, not fitted; if they sum
// to the number of samples, one degree of freedom is lost.
ChiSquaredResult chi_squared_test(std::span<const double> observed, std::span<const double> expected);

// Mean and its standard error.
class Mean {
 public:
    void add(double x) {
        ++count_;
        double d = x - mean_;
        mean_ += d / double(count_);
        sum_ += d * (x - mean_);
    }
    double value() const { return mean_; }
    double error() const;
    size_t count() const { return count_; }

 private:
    size_t count_ = 0;
    double mean_ = 0, sum_ = 0;
};

}  // namespace lampyris::test

#include "core/scene/number.h"

#include <charconv>
#include <limits>

namespace lampyris {
namespace {

// Whether a number outside of the range of floats is tiny (and becomes zero) rather than huge.
bool is_tiny(const char* p, const char* end) {
    if (p != end && *p == '-') ++p;
    int64_t leading = 0;  // decimal exponent of the first digit that is not zero
    bool point = false, found = false;
    for (; p != end && (is_digit(*p) || *p == '.'); ++p) {
        if (*p == '.') {
            point = true;
        } else if (found) {
            leading += point ? 0 : 1;
        } else {
            found = *p != '0';
            leading -= point ? 1 : 0;
        }
    }
    if (!found) return true;
    int64_t exponent = 0;
    if (p != end) {
        const bool negative = p + 1 != end && p[1] == '-';
        for (++p; p != end; ++p)
            if (is_digit(*p) && exponent < 1000000000000) exponent = 10 * exponent + (*p - '0');
        if (negative) exponent = -exponent;
    }
    return leading + exponent < 0;
}

template <typename T>
NumberStatus exact(const char* begin, const char* end, T& value) {
    if (begin != end && *begin == '+') ++begin;  // from_chars knows no plus sign
    T result = 0;
    const auto [stop, code] = std::from_chars(begin, end, result);
    if (code == std::errc::result_out_of_range || result > std::numeric_limits<T>::max() ||
        result < std::numeric_limits<T>::lowest()) {
        if (!is_tiny(begin, end)) return NumberStatus::kOutOfRange;
        value = *begin == '-' ? T(-0.0) : T(0);
        return NumberStatus::kOk;
    }
    if (code != std::errc() || stop != end) return NumberStatus::kNotANumber;
    value = result;
    return NumberStatus::kOk;
}

}  // namespace

NumberStatus exact_float(const char* begin, const char* end, float& value) { return exact(begin, end, value); }
NumberStatus exact_double(const char* begin, const char* end, double& value) { return exact(begin, end, value); }

}  // namespace lampyris

// Text to numbers: exact (the nearest float or double to the decimal text), and fast if double arithmetic suffices.
#pragma once

#include <cstdint>
#include <cstring>

namespace lampyris {

enum class NumberStatus { kOk, kNotANumber, kOutOfRange };

// Where the number's text ends, and whether it is a number. A number ends at a blank, a bracket, a quote, '#' or the end of the
// text. Any other character makes the whole word not a number.
struct NumberResult {
    const char* end;
    NumberStatus status;
};

inline bool is_digit(char c) { return static_cast<unsigned char>(c - '0') < 10; }
inline bool ends_number(char c) {
    return c == ' ' || c == '\n' || c == ']' || c == '\t' || c == '\r' || c == '[' || c == '"' || c == '#';
}

// The parts of a decimal number: mantissa * 10^exponent; `exact` where all digits fitted into the mantissa.
struct Decimal {
    uint64_t mantissa = 0;
    int64_t exponent = 0;
    bool negative = false;
    bool exact = false;
};

inline NumberResult scan_decimal(const char* p, const char* end, Decimal& decimal) {
    constexpr int kMaxDigits = 19;  // 10^19 - 1 fits into 64 bits
    if (p != end && (*p == '-' || *p == '+')) decimal.negative = *p++ == '-';
    const char* integer = p;
    for (; p != end && is_digit(*p); ++p) decimal.mantissa = 10 * decimal.mantissa + static_cast<uint64_t>(*p - '0');
    int64_t digits = p - integer;
    if (p != end && *p == '.') {
        const char* fraction = ++p;
        for (; p != end && is_digit(*p); ++p)
            decimal.mantissa = 10 * decimal.mantissa + static_cast<uint64_t>(*p - '0');
        decimal.exponent = fraction - p;
        digits += p - fraction;
    }
    decimal.exact = digits <= kMaxDigits;
    if (digits > 0 && p != end && (*p == 'e' || *p == 'E')) {
        ++p;
        const bool negative = p != end && *p == '-';
        if (p != end && (*p == '-' || *p == '+')) ++p;
        const char* first = p;
        int64_t exponent = 0;
        for (; p != end && is_digit(*p); ++p)
            if (exponent < 1000000) exponent = 10 * exponent + (*p - '0');
        if (p == first) digits = 0;
        decimal.exponent += negative ? -exponent : exponent;
    }
    if (digits > 0 && (p == end || ends_number(*p))) return {p, NumberStatus::kOk};
    while (p != end && !ends_number(*p)) ++p;
    return {p, NumberStatus::kNotANumber};
}

// The exact conversions, for numbers that the fast paths cannot convert (number.cpp); begin..end is a number.
NumberStatus exact_float(const char* begin, const char* end, float& value);
NumberStatus exact_double(const char* begin, const char* end, double& value);

// 10^0 .. 10^22, the powers of ten that a double holds exactly.
inline constexpr double kExactPowersOfTen[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                               1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

// Clinger's fast path: an integer below 2^53 and an exact power of ten make one correctly rounded operation.
inline bool fast_double(const Decimal& decimal, double& value) {
    constexpr uint64_t kMaxExact = uint64_t(1) << 53;
    if (!decimal.exact || decimal.mantissa > kMaxExact || decimal.exponent < -22 || decimal.exponent > 22) return false;
    const auto mantissa = static_cast<double>(decimal.mantissa);
    value = decimal.exponent < 0 ? mantissa / kExactPowersOfTen[-decimal.exponent]
                                 : mantissa * kExactPowersOfTen[decimal.exponent];
    if (decimal.negative) value = -value;
    return true;
}

inline NumberResult parse_double(const char* begin, const char* end, double& value) {
    Decimal decimal;
    NumberResult result = scan_decimal(begin, end, decimal);
    if (result.status == NumberStatus::kOk && !fast_double(decimal, value))
        result.status = exact_double(begin, result.end, value);
    return result;
}

inline NumberResult parse_float(const char* begin, const char* end, float& value) {
    Decimal decimal;
    NumberResult result = scan_decimal(begin, end, decimal);
    if (result.status != NumberStatus::kOk) return result;
    double wide;
    if (fast_double(decimal, wide)) {
        // Rounding twice (to double, then to float) goes wrong only next to the midpoint of two floats: the 29 bits that float
        // lacks are then within one of 1000...0. Denormals and numbers too large for a float take the exact path, too.
        uint64_t bits;
        std::memcpy(&bits, &wide, sizeof bits);
        const uint64_t exponent = (bits >> 52) & 0x7ffu;
        const uint64_t lost = bits & 0x1fffffffu;
        if ((lost - 0x0fffffffu > 2u && exponent - 897u < 253u) || decimal.mantissa == 0) {
            value = static_cast<float>(wide);
            return result;
        }
    }
    result.status = exact_float(begin, result.end, value);
    return result;
}

inline NumberResult parse_int(const char* begin, const char* end, int32_t& value) {
    const char* p = begin;
    const bool negative = p != end && *p == '-';
    if (p != end && (*p == '-' || *p == '+')) ++p;
    const char* first = p;
    int64_t wide = 0;
    bool fits = true;
    for (; p != end && is_digit(*p); ++p) {
        wide = 10 * wide + (*p - '0');
        if (wide > int64_t(INT32_MAX) + 1) {
            fits = false;
            wide = 0;
        }
    }
    if (p == first || (p != end && !ends_number(*p))) {
        while (p != end && !ends_number(*p)) ++p;
        return {p, NumberStatus::kNotANumber};
    }
    if (negative) wide = -wide;
    if (!fits || wide > INT32_MAX) return {p, NumberStatus::kOutOfRange};
    value = static_cast<int32_t>(wide);
    return {p, NumberStatus::kOk};
}

}  // namespace lampyris

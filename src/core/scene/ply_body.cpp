#include "core/scene/ply_body.h"

#include "core/base/error.h"
#include "core/scene/number.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace lampyris {
namespace {

template <typename T>
T load(const char* p, bool swap) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), p, sizeof(T));
    if (swap) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
}

}  // namespace

double load_as_double(const char* p, PlyType type, bool swap) {
    switch (type) {
        case PlyType::kInt8: return load<int8_t>(p, swap);
        case PlyType::kUint8: return load<uint8_t>(p, swap);
        case PlyType::kInt16: return load<int16_t>(p, swap);
        case PlyType::kUint16: return load<uint16_t>(p, swap);
        case PlyType::kInt32: return load<int32_t>(p, swap);
        case PlyType::kUint32: return load<uint32_t>(p, swap);
        case PlyType::kFloat32: return load<float>(p, swap);
        case PlyType::kFloat64: return load<double>(p, swap);
    }
    return 0.0;
}

PlyBody::PlyBody(const std::string& name, std::string_view bytes)
    : name_(name),
      bytes_(bytes),
      header_(parse_ply_header(name, bytes)),
      p_(bytes.data() + header_.body),
      end_(bytes.data() + bytes.size()),
      ascii_(header_.format == PlyFormat::kAscii),
      swap_((header_.format == PlyFormat::kBigEndian) != (std::endian::native == std::endian::big)) {}

void PlyBody::fail_in_header(size_t offset, const std::string& message, const std::string& hint) const {
    fail_at_text(name_, bytes_, offset, message, hint);
}

void PlyBody::fail(const char* place, const std::string& message) const {
    const auto offset = static_cast<size_t>(place - bytes_.data());
    if (ascii_) fail_at_text(name_, bytes_, offset, message);
    throw InputError(name_ + ": error: " + message + " (at byte " + std::to_string(offset) + ")");
}

void PlyBody::fail_truncated(const PlyElement& element) const {
    fail(end_, "the file ends before the " + std::to_string(element.count) + " elements \"" + shown(element.name) +
                   "\" that its header promises");
}

void PlyBody::check_size(const PlyElement& element) const {
    uint64_t least = 0;  // bytes of one row
    for (const PlyProperty& property : element.properties)
        least += ascii_ ? 2 : size_of(property.is_list ? property.count_type : property.type);
    const auto left = static_cast<uint64_t>(end_ - p_) + (ascii_ ? 1 : 0);  // the last value needs no blank after it
    if (least > 0 && element.count > left / least) fail_truncated(element);
}

size_t PlyBody::stride_of(const PlyElement& element) const {
    size_t stride = 0;
    for (const PlyProperty& property : element.properties) {
        if (property.is_list) return 0;
        stride += size_of(property.type);
    }
    return ascii_ ? 0 : stride;
}

double PlyBody::read_value(const PlyElement& element, PlyType type) {
    if (!ascii_) {
        const size_t size = size_of(type);
        if (static_cast<size_t>(end_ - p_) < size) fail_truncated(element);
        const double value = load_as_double(p_, type, swap_);
        p_ += size;
        return value;
    }
    while (p_ != end_ && (*p_ == ' ' || *p_ == '\n' || *p_ == '\r' || *p_ == '\t')) ++p_;
    if (p_ == end_) fail_truncated(element);
    double value = 0.0;
    NumberResult result{};
    if (type == PlyType::kFloat32) {
        float narrow = 0.0f;
        result = parse_float(p_, end_, narrow);
        value = narrow;
    } else {
        result = parse_double(p_, end_, value);
    }
    if (result.status == NumberStatus::kNotANumber)
        fail(p_, "expected a number, found \"" +
                     shown({p_, static_cast<size_t>(std::max(result.end - p_, ptrdiff_t(1)))}) + "\"");
    if (result.status == NumberStatus::kOutOfRange) fail(p_, "number out of range");
    p_ = result.end;
    return value;
}

int64_t PlyBody::read_integer(const PlyElement& element, PlyType type) {
    const char* place = p_;
    const double value = read_value(element, type);
    if (value != std::floor(value) || std::abs(value) > 4294967295.0) fail(place, "expected a 32-bit integer");
    return static_cast<int64_t>(value);
}

uint64_t PlyBody::read_count(const PlyElement& element, const PlyProperty& property) {
    const char* place = p_;
    const int64_t count = read_integer(element, property.count_type);
    if (count < 0) fail(place, "a list of \"" + shown(element.name) + "\" has a negative length");
    const uint64_t least = ascii_ ? 2 : size_of(property.type);
    if (static_cast<uint64_t>(count) > (static_cast<uint64_t>(end_ - p_) + 1) / least) fail_truncated(element);
    return static_cast<uint64_t>(count);
}

void PlyBody::skip_values(const PlyElement& element, PlyType type, uint64_t count) {
    if (ascii_) {
        for (uint64_t i = 0; i < count; ++i) read_value(element, type);
    } else {
        if (count > static_cast<uint64_t>(end_ - p_) / size_of(type)) fail_truncated(element);
        p_ += count * size_of(type);
    }
}

void PlyBody::skip(const PlyElement& element) {
    if (element.properties.empty()) return;
    if (const size_t stride = stride_of(element)) {
        p_ += element.count * stride;  // check_size saw that it fits
        return;
    }
    for (uint64_t row = 0; row < element.count; ++row)
        for (const PlyProperty& property : element.properties)
            skip_values(element, property.type, property.is_list ? read_count(element, property) : 1);
}

}  // namespace lampyris

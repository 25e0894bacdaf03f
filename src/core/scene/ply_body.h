// The data after the header of a PLY file, value by value, in any of its formats. Internal to ply*.cpp.
#pragma once

#include "core/scene/ply_header.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace lampyris {

// Every PLY type fits into a double exactly. `swap`: the byte order is not the machine's.
double load_as_double(const char* p, PlyType type, bool swap);

// Both arguments must outlive it. The reading functions throw InputError if the file does not match its header.
class PlyBody {
 public:
    PlyBody(const std::string& name, std::string_view bytes);

 protected:
    [[noreturn]] void fail_in_header(size_t offset, const std::string& message, const std::string& hint = {}) const;
    [[noreturn]] void fail(const char* place, const std::string& message) const;
    [[noreturn]] void fail_truncated(const PlyElement& element) const;

    // Rejects a header that promises more than the file can hold, before memory is allocated for it.
    void check_size(const PlyElement& element) const;
    // Bytes of a row of the element; 0 where rows differ in size.
    size_t stride_of(const PlyElement& element) const;

    // The next value, in any of the formats.
    double read_value(const PlyElement& element, PlyType type);
    int64_t read_integer(const PlyElement& element, PlyType type);
    uint64_t read_count(const PlyElement& element, const PlyProperty& property);
    void skip_values(const PlyElement& element, PlyType type, uint64_t count);
    void skip(const PlyElement& element);

    const std::string& name_;
    std::string_view bytes_;
    PlyHeader header_;
    const char *p_, *end_;  // what is left to read
    bool ascii_, swap_;
};

}  // namespace lampyris

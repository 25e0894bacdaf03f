// The header of a PLY file, and the reporting of its errors. Internal to ply*.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
size_t size_of(PlyType type);
inline bool is_integer(PlyType type) { return type < PlyType::kFloat32; }

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::kFloat32;  // of a list: of its members
    bool is_list = false;
    PlyType count_type = PlyType::kUint8;
};

struct PlyElement {
    std::string name;
    uint64_t count = 0;
    std::vector<PlyProperty> properties;
    size_t offset = 0;  // of its line in the header
};

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

struct PlyHeader {
    PlyFormat format = PlyFormat::kAscii;
    std::vector<PlyElement> elements;
    size_t body = 0;  // offset of the first byte after the header
};

// Throws InputError for a place in a PLY file's text (header, ascii body): with line, column and excerpt.
[[noreturn]] void fail_at_text(const std::string& name, std::string_view bytes, size_t offset,
                               const std::string& message, const std::string& hint = {});

PlyHeader parse_ply_header(const std::string& name, std::string_view bytes);

}  // namespace lampyris

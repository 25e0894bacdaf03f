#include "core/scene/ply_header.h"

#include "core/base/error.h"

#include <algorithm>
#include <charconv>
#include <optional>

namespace lampyris {
namespace {

struct TypeName {
    std::string_view name;
    PlyType type;
};
constexpr TypeName kTypeNames[] = {
    {"char", PlyType::kInt8},       {"uchar", PlyType::kUint8},    {"short", PlyType::kInt16},
    {"ushort", PlyType::kUint16},   {"int", PlyType::kInt32},      {"uint", PlyType::kUint32},
    {"float", PlyType::kFloat32},   {"double", PlyType::kFloat64}, {"int8", PlyType::kInt8},
    {"uint8", PlyType::kUint8},     {"int16", PlyType::kInt16},    {"uint16", PlyType::kUint16},
    {"int32", PlyType::kInt32},     {"uint32", PlyType::kUint32},  {"float32", PlyType::kFloat32},
    {"float64", PlyType::kFloat64},
};

class HeaderParser {
 public:
    HeaderParser(const std::string& name, std::string_view bytes) : name_(name), bytes_(bytes) {}

    PlyHeader parse() {
        if (!next_line() || words_.size() != 1 || words_[0] != "ply")
            fail(0, "this is not a PLY file: its first line is not \"ply\"");
        bool has_format = false;
        while (true) {
            if (!next_line())
                fail(bytes_.size(), "the header does not end", "a PLY header ends with a line \"end_header\"");
            if (words_.empty() || words_[0] == "comment" || words_[0] == "obj_info") continue;
            if (words_[0] == "end_header") break;
            if (words_[0] == "format") {
                parse_format();
                has_format = true;
            } else if (words_[0] == "element") {
                parse_element();
            } else if (words_[0] == "property") {
                parse_property();
            } else {
                fail(offset_of(0),
                     "unknown header line \"" + shown(words_[0]) + "\"" +
                         did_you_mean(words_[0], {"format", "element", "property", "comment", "end_header"}));
            }
        }
        if (!has_format)
            fail(0, "the header has no \"format\" line", "write format binary_little_endian 1.0, for instance");
        header_.body = position_;
        return std::move(header_);
    }

 private:
    [[noreturn]] void fail(size_t offset, const std::string& message, const std::string& hint = {}) const {
        fail_at_text(name_, bytes_, offset, message, hint);
    }
    size_t offset_of(size_t word) const {
        return word < words_.size() ? static_cast<size_t>(words_[word].data() - bytes_.data()) : line_;
    }

    bool next_line() {
        words_.clear();
        if (position_ >= bytes_.size()) return false;
        constexpr size_t kMaxLine = 4096;  // a binary file without newlines is not searched to its end
        line_ = position_;
        const size_t newline = bytes_.substr(line_, kMaxLine).find('\n');
        if (newline == std::string_view::npos) return false;
        position_ = line_ + newline + 1;
        const std::string_view line = bytes_.substr(line_, newline);
        for (size_t start = 0; (start = line.find_first_not_of(" \t\r", start)) != std::string_view::npos;) {
            const size_t stop = std::min(line.find_first_of(" \t\r", start), line.size());
            words_.push_back(line.substr(start, stop - start));
            start = stop;
        }
        return true;
    }

    void parse_format() {
        static const std::vector<std::string> kFormats{"ascii", "binary_little_endian", "binary_big_endian"};
        const std::string_view format = words_.size() > 1 ? words_[1] : std::string_view();
        const auto known = std::find(kFormats.begin(), kFormats.end(), format);
        if (known == kFormats.end())
            fail(offset_of(1), "unknown PLY format \"" + shown(format) + "\"" + did_you_mean(format, kFormats),
                 "formats are " + list_of(kFormats));
        if (words_.size() != 3 || words_[2] != "1.0") fail(offset_of(2), "the only PLY version is 1.0");
        header_.format = static_cast<PlyFormat>(known - kFormats.begin());
    }

    void parse_element() {
        if (words_.size() != 3)
            fail(line_, "an element has a name and a count", "write element vertex 8, for instance");
        PlyElement element;
        element.name = words_[1];
        element.offset = line_;
        const auto [stop, code] = std::from_chars(words_[2].data(), words_[2].data() + words_[2].size(), element.count);
        if (code != std::errc() || stop != words_[2].data() + words_[2].size())
            fail(offset_of(2), "\"" + shown(words_[2]) + "\" is no count of elements");
        for (const PlyElement& other : header_.elements)
            if (other.name == element.name)
                fail(offset_of(1), "element \"" + shown(element.name) + "\" is declared twice");
        constexpr size_t kMaxElements = 1000, kMaxProperties = 1000;
        if (header_.elements.size() >= kMaxElements)
            fail(line_, "more than " + std::to_string(kMaxElements) + " elements");
        max_properties_ = kMaxProperties;
        header_.elements.push_back(std::move(element));
    }

    PlyType type_of(size_t word) const {
        for (const TypeName& known : kTypeNames)
            if (words_[word] == known.name) return known.type;
        std::vector<std::string> names;
        for (const TypeName& known : kTypeNames) names.emplace_back(known.name);
        fail(offset_of(word), "unknown type \"" + shown(words_[word]) + "\"" + did_you_mean(words_[word], names),
             "types are " + list_of(names));
    }

    void parse_property() {
        if (header_.elements.empty()) fail(line_, "a property before the first element");
        PlyElement& element = header_.elements.back();
        PlyProperty property;
        property.is_list = words_.size() > 1 && words_[1] == "list";
        if (words_.size() != (property.is_list ? 5u : 3u))
            fail(line_, "a property has a type and a name",
                 "write property float x or property list uchar int vertex_indices, for instance");
        if (property.is_list) {
            property.count_type = type_of(2);
            if (!is_integer(property.count_type)) fail(offset_of(2), "the count of a list is an integer");
        }
        property.type = type_of(property.is_list ? 3 : 1);
        property.name = words_.back();
        for (const PlyProperty& other : element.properties)
            if (other.name == property.name)
                fail(line_,
                     "property \"" + shown(property.name) + "\" of \"" + shown(element.name) + "\" is declared twice");
        if (element.properties.size() >= max_properties_)
            fail(line_, "more than " + std::to_string(max_properties_) + " properties of one element");
        element.properties.push_back(std::move(property));
    }

    const std::string& name_;
    std::string_view bytes_;
    size_t position_ = 0, line_ = 0, max_properties_ = 0;
    std::vector<std::string_view> words_;
    PlyHeader header_;
};

}  // namespace

size_t size_of(PlyType type) {
    static constexpr size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return kSizes[static_cast<size_t>(type)];
}

void fail_at_text(const std::string& name, std::string_view bytes, size_t offset, const std::string& message,
                  const std::string& hint) {
    Sources sources;
    const uint32_t file = sources.add(name, bytes);
    Diagnostics diagnostics(sources);
    diagnostics.error({file, offset}, message, hint);
    diagnostics.throw_if_errors();
    throw InputError(message);  // not reached
}

PlyHeader parse_ply_header(const std::string& name, std::string_view bytes) {
    return HeaderParser(name, bytes).parse();
}

}  // namespace lampyris

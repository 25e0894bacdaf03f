// The bytes of an input file: memory-mapped, or read into memory where the file is small, and decompressed where it is gzip'd.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace lampyris {

class FileText {
 public:
    // Opens a regular file. On failure the result is empty, and `why` holds the reason. A gzip'd file is recognised by its
    // first bytes, not by its name.
    static std::shared_ptr<const FileText> open(const std::string& path, std::string& why);
    ~FileText();
    FileText(const FileText&) = delete;
    FileText& operator=(const FileText&) = delete;

    std::string_view text() const { return text_; }
    // Releases the memory of a mapped file's pages before `offset`; they are read again if needed (for an error's excerpt).
    void release_before(size_t offset) const;

 private:
    FileText() = default;
    void* mapping_ = nullptr;
    size_t mapping_size_ = 0;
    std::string read_;  // owned text of small or gzip'd files
    std::string_view text_;
};

// A gzip'd file may inflate to the larger one of this size, and this multiple of its own.
inline constexpr size_t kLargestInflatedSize = size_t(256) << 20;
inline constexpr size_t kLargestInflation = 64;
bool is_gzip(std::string_view bytes);
// The decompressed contents of a gzip stream, which may have several members. False, with the reason in `why`, if it is
// damaged, or becomes too large.
bool inflate_gzip(std::string_view bytes, std::string& result, std::string& why);

}  // namespace lampyris

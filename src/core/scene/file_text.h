// The bytes of an input file: memory-mapped, or read into memory where the file is small, and decompressed where it is gzip'd.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace lampyris {

class FileText {
 public:
    // Opens a regular file. Nothing, with the reason in `why`, where that cannot be done. Whether a file is gzip'd is
    // told by its first bytes, not by its name.
    static std::shared_ptr<const FileText> open(const std::string& path, std::string& why);
    ~FileText();
    FileText(const FileText&) = delete;
    FileText& operator=(const FileText&) = delete;

    std::string_view text() const { return text_; }
    // Gives back the memory of a mapped file's pages before `offset`; they are read again if needed (an error's excerpt).
    void release_before(size_t offset) const;

 private:
    FileText() = default;
    void* mapping_ = nullptr;
    size_t mapping_size_ = 0;
    std::string read_;  // of small or gzip'd files
    std::string_view text_;
};

bool is_gzip(std::string_view bytes);
// The contents of a gzip stream (of several members, too). False, with the reason in `why`, where it is damaged.
bool inflate_gzip(std::string_view bytes, std::string& result, std::string& why);

}  // namespace lampyris

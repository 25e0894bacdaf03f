#include "core/scene/file_text.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>

namespace lampyris {

bool is_gzip(std::string_view bytes) { return bytes.size() >= 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b'; }

bool inflate_gzip(std::string_view bytes, std::string& result, std::string& why) {
    z_stream stream{};
    constexpr int kGzipOnly = 16 + MAX_WBITS;
    if (inflateInit2(&stream, kGzipOnly) != Z_OK) {
        why = "the decompressor cannot be started";
        return false;
    }
    std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, inflateEnd);
    result.clear();
    // Grows with the actual data, so that the size which a small file claims cannot make it allocate much memory; and not beyond
    // what scenes and meshes take. The format itself reaches 1032 to 1.
    const size_t most = std::max(kLargestInflatedSize, kLargestInflation * bytes.size());
    size_t produced = 0;
    size_t consumed = 0;
    while (true) {
        if (produced == result.size()) result.resize(std::max<size_t>(2 * result.size(), 4 * bytes.size() + 64));
        constexpr size_t kMaxChunk = std::numeric_limits<uInt>::max() / 2;
        const size_t in = std::min(bytes.size() - consumed, kMaxChunk);
        const size_t out = std::min(result.size() - produced, kMaxChunk);
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + consumed));
        stream.avail_in = static_cast<uInt>(in);
        stream.next_out = reinterpret_cast<Bytef*>(result.data() + produced);
        stream.avail_out = static_cast<uInt>(out);
        const int status = inflate(&stream, Z_NO_FLUSH);
        const bool progress = stream.avail_in < in || stream.avail_out < out;
        consumed += in - stream.avail_in;
        produced += out - stream.avail_out;
        if (produced > most) {
            why = fmt::format(
                "the gzip'd data becomes more than {} times as large, and more than {} MiB; unpack it with gunzip",
                kLargestInflation, kLargestInflatedSize >> 20);
            return false;
        }
        if (status == Z_STREAM_END) {
            // Another member may follow; anything else after the end is padding, as gzip itself sees it.
            if (!is_gzip(bytes.substr(consumed))) break;
            inflateReset(&stream);
        } else if (status != Z_OK && status != Z_BUF_ERROR) {
            why = "the gzip'd data is damaged at byte " + std::to_string(consumed);
            return false;
        } else if (!progress) {  // there was room for output, so the input ended too early
            why = "the gzip'd data ends too early";
            return false;
        }
    }
    result.resize(produced);
    result.shrink_to_fit();
    return true;
}

std::shared_ptr<const FileText> FileText::open(const std::string& path, std::string& why) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) {
        why = std::strerror(errno);
        return nullptr;
    }
    struct Closer {
        int descriptor;
        ~Closer() { ::close(descriptor); }
    } closer{descriptor};
    struct stat status {};
    if (fstat(descriptor, &status) != 0) {
        why = std::strerror(errno);
        return nullptr;
    }
    // Reading a device or a pipe may never end.
    if (!S_ISREG(status.st_mode)) {
        why = S_ISDIR(status.st_mode) ? "it is a directory" : "it is not a regular file";
        return nullptr;
    }
    std::shared_ptr<FileText> file(new FileText);
    if (status.st_size == 0) return file;
    // A process may have 65530 mappings (vm.max_map_count), and a scene may consist of more files than that.
    constexpr off_t kSmall = 65536;
    if (status.st_size <= kSmall) {
        file->read_.resize(static_cast<size_t>(status.st_size));
        size_t have = 0;
        while (have < file->read_.size()) {
            const ssize_t got = ::read(descriptor, file->read_.data() + have, file->read_.size() - have);
            if (got < 0 && errno == EINTR) continue;
            if (got < 0) {
                why = std::strerror(errno);
                return nullptr;
            }
            if (got == 0) break;  // the file has been truncated meanwhile
            have += static_cast<size_t>(got);
        }
        file->read_.resize(have);
        if (is_gzip(file->read_)) {
            std::string inflated;
            if (!inflate_gzip(file->read_, inflated, why)) return nullptr;
            file->read_ = std::move(inflated);
        }
        file->text_ = file->read_;
        return file;
    }
    file->mapping_size_ = static_cast<size_t>(status.st_size);
    file->mapping_ = mmap(nullptr, file->mapping_size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (file->mapping_ == MAP_FAILED) {
        file->mapping_ = nullptr;
        why = std::strerror(errno);
        return nullptr;
    }
    madvise(file->mapping_, file->mapping_size_, MADV_SEQUENTIAL);
    file->text_ = {static_cast<const char*>(file->mapping_), file->mapping_size_};
    if (is_gzip(file->text_)) {
        if (!inflate_gzip(file->text_, file->read_, why)) return nullptr;
        munmap(file->mapping_, file->mapping_size_);
        file->mapping_ = nullptr;
        file->text_ = file->read_;
    }
    return file;
}

FileText::~FileText() {
    if (mapping_) munmap(mapping_, mapping_size_);
}

void FileText::release_before(size_t offset) const {
    if (!mapping_) return;
    const auto page = static_cast<size_t>(sysconf(_SC_PAGESIZE));
    const size_t size = std::min(offset, mapping_size_) / page * page;
    if (size > 0) madvise(mapping_, size, MADV_DONTNEED);
}

}  // namespace lampyris

#include "core/base/file.h"

#include "core/base/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace lampyris {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, int error) {
    throw MachineError(fmt::format("cannot write '{}': {}", path, std::strerror(error)));
}

// Closes the file on every path. A full disk may only be reported by close(), so the successful path calls it explicitly.
class Descriptor {
 public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return fd_; }
    int close() { return ::close(std::exchange(fd_, -1)); }

 private:
    int fd_;
};

int write_all(int fd, std::span<const std::byte> bytes) {  // 0, or errno
    while (!bytes.empty()) {
        const ssize_t n = ::write(fd, bytes.data(), bytes.size());
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return errno;
        bytes = bytes.subspan(size_t(n));
    }
    return 0;
}

std::string follow_links(const std::string& path) {
    std::error_code ignored;
    if (!fs::is_symlink(path, ignored)) return path;
    const fs::path target = fs::weakly_canonical(path, ignored);
    return ignored ? path : target.string();
}

std::string temporary_beside(const std::string& path) {
    const fs::path target(path);
    return (target.parent_path() / fmt::format(".{}.{}.part", target.filename().string(), ::getpid())).string();
}

}  // namespace

void write_file_atomically(const std::string& path, std::span<const std::byte> bytes) {
    const std::string target = follow_links(path);
    struct stat info {};
    const bool exists = ::stat(target.c_str(), &info) == 0;
    if (exists && S_ISDIR(info.st_mode)) fail(path, EISDIR);
    if (exists && !S_ISREG(info.st_mode)) {
        Descriptor file(::open(target.c_str(), O_WRONLY | O_CLOEXEC));
        if (file.get() < 0) fail(path, errno);
        if (const int error = write_all(file.get(), bytes)) fail(path, error);
        if (file.close() != 0) fail(path, errno);
        return;
    }
    const std::string temporary = temporary_beside(target);
    Descriptor file(
        ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, exists ? info.st_mode & 07777 : 0666));
    if (file.get() < 0) fail(path, errno);
    int error = write_all(file.get(), bytes);
    if (error == 0 && ::fsync(file.get()) != 0 && errno != EINVAL)
        error = errno;  // EINVAL: a file system without fsync
    if (file.close() != 0 && error == 0) error = errno;
    if (error == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
    if (error != 0) {
        ::unlink(temporary.c_str());
        fail(path, error);
    }
}

void write_file_atomically(const std::string& path, std::string_view text) {
    write_file_atomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

void check_writable(const std::string& path) {
    const std::string target = follow_links(path);
    struct stat info {};
    if (::stat(target.c_str(), &info) == 0) {
        if (S_ISDIR(info.st_mode)) throw InputError(fmt::format("cannot write '{}': it is a folder", path));
        if (!S_ISREG(info.st_mode)) return;
    }
    fs::path folder = fs::path(target).parent_path();
    if (folder.empty()) folder = ".";
    if (::stat(folder.c_str(), &info) != 0)
        throw InputError(fmt::format("cannot write '{}': the folder '{}' cannot be opened: {}", path, folder.string(),
                                     std::strerror(errno)));
    if (!S_ISDIR(info.st_mode))
        throw InputError(fmt::format("cannot write '{}': '{}' is not a folder", path, folder.string()));
    // access() checks the real user's permissions; only an attempt shows what the file system (read-only, quota) really allows.
    const std::string temporary = temporary_beside(target);
    const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (fd < 0) fail(path, errno);
    ::close(fd);
    ::unlink(temporary.c_str());
}

std::vector<std::string> files_beside(const std::filesystem::path& path) {
    std::error_code ignored;
    std::vector<std::string> names;
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    for (const auto& entry : fs::directory_iterator(folder, ignored)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace lampyris

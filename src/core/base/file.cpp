#include "core/base/file.h"

#include "core/base/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <filesystem>
#include <random>
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

// Where a link leads; a dangling one, too.
std::string follow_links(const std::string& path) {
    constexpr int kMostLinks = 40;  // as many as the system follows
    std::error_code ignored;
    if (!fs::is_symlink(path, ignored)) return path;
    if (fs::exists(path, ignored)) {
        const fs::path target = fs::canonical(path, ignored);
        return ignored ? path : target.string();  // an open pipe (/dev/stdout) has no other name
    }
    fs::path target(path);
    for (int i = 0; i < kMostLinks && fs::is_symlink(target, ignored); ++i) {
        const fs::path next = fs::read_symlink(target, ignored);
        if (ignored) break;
        target = target.parent_path() / next;  // the latter alone if it is absolute
    }
    if (fs::is_symlink(target, ignored)) fail(path, ELOOP);
    return target.string();
}

std::string folder_of(const std::string& path) {
    const std::string folder = fs::path(path).parent_path().string();
    return folder.empty() ? "." : folder;
}

// Beside the target, whose own name may be as long as a name can be; nobody can foretell it.
std::string unfinished_name(const std::string& folder) {
    std::random_device random;
    return fmt::format("{}/.lampyris-{:08x}{:08x}.part", folder, random(), random());
}

// A file that is not complete yet. It has no name until then, so that a program that is killed leaves none behind; or, where the
// file system has no such files, the name of a file that was not there before.
class Unfinished {
 public:
    Unfinished(const std::string& folder, mode_t mode) : folder_(folder) {
        fd_ = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, mode);
        if (fd_ < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL)) {
            do name_ = unfinished_name(folder);
            while ((fd_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode)) < 0 && errno == EEXIST);
        }
        error_ = fd_ < 0 ? errno : 0;
        if (fd_ < 0) name_.clear();
    }
    ~Unfinished() {
        if (fd_ >= 0) ::close(fd_);
        if (!name_.empty()) ::unlink(name_.c_str());
    }
    Unfinished(const Unfinished&) = delete;
    Unfinished& operator=(const Unfinished&) = delete;

    int error() const { return error_; }  // errno, or 0

    // Each step is left out after an error. A full disk may only be reported by the last ones.
    void write(std::span<const std::byte> bytes) {
        if (error_ == 0) error_ = write_all(fd_, bytes);
        // EINVAL: a file system without fsync
        if (error_ == 0 && ::fsync(fd_) != 0 && errno != EINVAL) error_ = errno;
    }
    void become(const std::string& target) {
        if (error_ == 0 && name_.empty()) link();
        if (fd_ >= 0 && ::close(std::exchange(fd_, -1)) != 0 && error_ == 0) error_ = errno;
        if (error_ == 0 && ::rename(name_.c_str(), target.c_str()) != 0) error_ = errno;
        if (error_ == 0) name_.clear();
    }

 private:
    // A link cannot replace a file, a renamed one can.
    void link() {
        const std::string self = fmt::format("/proc/self/fd/{}", fd_);
        std::string name;
        int result;
        do {
            name = unfinished_name(folder_);
            result = ::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW);
        } while (result != 0 && errno == EEXIST);
        if (result != 0)
            error_ = errno;
        else
            name_ = name;
    }

    const std::string folder_;
    std::string name_;  // empty: none
    int fd_ = -1, error_ = 0;
};

// A pipe, a device. A pipe that nobody reads would block for ever.
void write_directly(const std::string& path, const std::string& target, std::span<const std::byte> bytes) {
    Descriptor file(::open(target.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK));
    if (file.get() < 0 && errno == ENXIO)
        throw MachineError(fmt::format("cannot write '{}': no program reads from this pipe", path));
    if (file.get() < 0) fail(path, errno);
    if (::fcntl(file.get(), F_SETFL, ::fcntl(file.get(), F_GETFL) & ~O_NONBLOCK) != 0) fail(path, errno);
    if (const int error = write_all(file.get(), bytes)) fail(path, error);
    if (file.close() != 0) fail(path, errno);
}

}  // namespace

void write_file_atomically(const std::string& path, std::span<const std::byte> bytes) {
    const std::string target = follow_links(path);
    struct stat info {};
    const bool exists = ::stat(target.c_str(), &info) == 0;
    if (exists && S_ISDIR(info.st_mode)) fail(path, EISDIR);
    // Another file could take its place, but whoever protected it did not want that.
    if (exists && ::faccessat(AT_FDCWD, target.c_str(), W_OK, AT_EACCESS) != 0) fail(path, errno);
    if (exists && !S_ISREG(info.st_mode)) return write_directly(path, target, bytes);
    Unfinished file(folder_of(target), exists ? info.st_mode & 07777 : 0666);
    file.write(bytes);
    file.become(target);
    if (file.error() != 0) fail(path, file.error());
}

void write_file_atomically(const std::string& path, std::string_view text) {
    write_file_atomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

void check_writable(const std::string& path) {
    const std::string target = follow_links(path);
    struct stat info {};
    if (::stat(target.c_str(), &info) == 0) {
        if (S_ISDIR(info.st_mode)) throw InputError(fmt::format("cannot write '{}': it is a folder", path));
        if (::faccessat(AT_FDCWD, target.c_str(), W_OK, AT_EACCESS) != 0) fail(path, errno);
        if (!S_ISREG(info.st_mode)) return;
    }
    const std::string folder = folder_of(target);
    if (::stat(folder.c_str(), &info) != 0)
        throw InputError(
            fmt::format("cannot write '{}': the folder '{}' cannot be opened: {}", path, folder, std::strerror(errno)));
    if (!S_ISDIR(info.st_mode)) throw InputError(fmt::format("cannot write '{}': '{}' is not a folder", path, folder));
    // access() checks the real user's permissions; only an attempt shows what the file system (read-only, quota) really allows.
    if (const int error = Unfinished(folder, 0666).error()) fail(path, error);
    if (fs::path(target).filename().string().size() > NAME_MAX) fail(path, ENAMETOOLONG);
}

std::string why_not_readable(const std::string& path) {
    struct stat info {};
    if (::stat(path.c_str(), &info) != 0 || S_ISREG(info.st_mode)) return {};
    return S_ISDIR(info.st_mode) ? "it is a folder" : "it is not a regular file";
}

std::string real_path(const std::filesystem::path& path) {
    namespace fs = std::filesystem;
    constexpr int kMostLinks = 40;  // as many as the system follows
    std::error_code error;
    fs::path result = fs::absolute(path, error);
    for (int i = 0; i < kMostLinks; ++i) {
        result = fs::weakly_canonical(result, error);
        if (error) return {};
        // A link that leads to nothing is left in it, and a file that is written there would be elsewhere.
        fs::path before, link;
        auto part = result.begin();
        for (; part != result.end() && link.empty(); ++part) {
            if (fs::is_symlink(before / *part, error)) link = before / *part;
            before /= *part;
        }
        if (link.empty()) return result.string();
        fs::path target = link.parent_path() / fs::read_symlink(link, error);
        if (error) return {};
        for (; part != result.end(); ++part) target /= *part;
        result = target;
    }
    return {};
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

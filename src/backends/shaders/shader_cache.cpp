#include "backends/shaders/shader_cache.h"

#include "core/base/error.h"
#include "core/base/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <span>
#include <system_error>
#include <vector>

namespace lampyris::shaders {
namespace {

constexpr uint64_t kMagic = 0x32565053'594d414cu;  // "LAMYSPV2", little endian

struct Header {
    uint64_t magic = kMagic;
    uint64_t words = 0;
    std::array<uint64_t, 2> checksum{};
};

// With the key: the file of another kernel under this name is none of ours.
std::array<uint64_t, 2> checksum_of(const ContentHash& key, const Words& words) {
    ContentHash hash;
    for (const uint64_t part : key.value()) hash.add(part);
    hash.add(std::string_view(reinterpret_cast<const char*>(words.data()), words.size() * sizeof(uint32_t)));
    return hash.value();
}

uint64_t mix(uint64_t x) {
    x ^= x >> 33;
    x *= 0xff51afd7ed558ccdu;
    x ^= x >> 33;
    x *= 0xc4ceb9fe1a85ec53u;
    return x ^ (x >> 33);
}

// What is in the cache is run: it must not be what somebody else could have written.
bool is_trusted(const struct stat& file) {
    return S_ISREG(file.st_mode) && (file.st_uid == geteuid() || file.st_uid == 0) &&
           (file.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

}  // namespace

void ContentHash::add(std::string_view bytes) {
    constexpr uint64_t kPrime = 0x100000001b3u;
    for (const char c : bytes) {
        a_ = (a_ ^ static_cast<unsigned char>(c)) * kPrime;
        b_ = (b_ + static_cast<unsigned char>(c) + 1) * 0x9e3779b97f4a7c15u;
        b_ ^= b_ >> 29;
    }
    add(static_cast<uint64_t>(bytes.size()));
}

void ContentHash::add(uint64_t value) {
    a_ = mix(a_ ^ value);
    b_ = mix(b_ + value);
}

std::array<uint64_t, 2> ContentHash::value() const { return {mix(a_), mix(b_ ^ a_)}; }

std::filesystem::path ShaderCache::path(const ContentHash& key) const {
    const auto value = key.value();
    return folder_ / fmt::format("{:016x}{:016x}{}", value[0], value[1], extension_);
}

std::optional<Words> ShaderCache::find(const ContentHash& key) const {
    if (folder_.empty()) return std::nullopt;
    const int descriptor = open(path(key).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // does not wait for a pipe
    if (descriptor < 0) return std::nullopt;
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(fdopen(descriptor, "rb"), &std::fclose);
    if (!file) {
        close(descriptor);
        return std::nullopt;
    }
    struct stat status {};
    if (fstat(descriptor, &status) != 0 || !is_trusted(status)) return std::nullopt;
    Header header;
    if (std::fread(&header, sizeof header, 1, file.get()) != 1 || header.magic != kMagic) return std::nullopt;
    const uint64_t bytes = uint64_t(status.st_size) - sizeof header;
    if (bytes % sizeof(uint32_t) != 0 || bytes / sizeof(uint32_t) != header.words) return std::nullopt;
    Words words(header.words);
    if (std::fread(words.data(), sizeof(uint32_t), words.size(), file.get()) != words.size()) return std::nullopt;
    if (checksum_of(key, words) != header.checksum) return std::nullopt;
    return words;
}

void ShaderCache::store(const ContentHash& key, const Words& words) const {
    if (folder_.empty()) return;
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    const std::filesystem::path name = path(key);
    // Whatever else has this name (a folder, a pipe) stays.
    if (std::filesystem::exists(name, error) && !std::filesystem::is_regular_file(name, error)) return;
    const Header header{kMagic, words.size(), checksum_of(key, words)};
    std::vector<std::byte> bytes(sizeof header + words.size() * sizeof(uint32_t));
    std::memcpy(bytes.data(), &header, sizeof header);
    const auto content = std::as_bytes(std::span(words));
    std::copy(content.begin(), content.end(), bytes.begin() + sizeof header);
    try {
        write_file_atomically(name.string(), std::span<const std::byte>(bytes));
        using std::filesystem::perms;
        std::filesystem::permissions(name, perms::group_write | perms::others_write,
                                     std::filesystem::perm_options::remove, error);
    } catch (const MachineError&) {  // the cache only saves time
    }
}

}  // namespace lampyris::shaders

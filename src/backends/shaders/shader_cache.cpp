#include "backends/shaders/shader_cache.h"

#include "core/base/error.h"
#include "core/base/file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
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
    const std::filesystem::path name = path(key);
    std::error_code error;
    if (!std::filesystem::is_regular_file(name, error)) return std::nullopt;  // a pipe could block for ever
    std::ifstream file(name, std::ios::binary);
    Header header;
    if (!file.read(reinterpret_cast<char*>(&header), sizeof header) || header.magic != kMagic) return std::nullopt;
    const uint64_t size = std::filesystem::file_size(name, error);
    if (error || (size - sizeof header) % sizeof(uint32_t) != 0 ||
        (size - sizeof header) / sizeof(uint32_t) != header.words)
        return std::nullopt;
    Words words(header.words);
    if (!file.read(reinterpret_cast<char*>(words.data()),
                   static_cast<std::streamsize>(header.words * sizeof(uint32_t))))
        return std::nullopt;
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
    } catch (const MachineError&) {  // the cache only saves time
    }
}

}  // namespace lampyris::shaders

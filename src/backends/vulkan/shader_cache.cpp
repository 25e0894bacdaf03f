#include "backends/vulkan/shader_cache.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <system_error>

namespace lampyris::vulkan {
namespace {

constexpr uint64_t kMagic = 0x31565053'594d414cu;  // "LAMYSPV1", little endian

struct Header {
    uint64_t magic = kMagic;
    uint64_t words = 0;
    std::array<uint64_t, 2> checksum{};
};

std::array<uint64_t, 2> checksum_of(const Spirv& spirv) {
    ContentHash hash;
    hash.add(std::string_view(reinterpret_cast<const char*>(spirv.data()), spirv.size() * sizeof(uint32_t)));
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

std::filesystem::path ShaderCache::default_folder() {
    if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg) return std::filesystem::path(xdg) / "lampyris";
    if (const char* home = std::getenv("HOME"); home && *home)
        return std::filesystem::path(home) / ".cache" / "lampyris";
    return {};
}

std::filesystem::path ShaderCache::path(const ContentHash& key) const {
    const auto value = key.value();
    return folder_ / fmt::format("{:016x}{:016x}.spv", value[0], value[1]);
}

std::optional<Spirv> ShaderCache::find(const ContentHash& key) const {
    if (folder_.empty()) return std::nullopt;
    std::ifstream file(path(key), std::ios::binary);
    Header header;
    if (!file.read(reinterpret_cast<char*>(&header), sizeof header) || header.magic != kMagic) return std::nullopt;
    std::error_code error;
    const auto size = std::filesystem::file_size(path(key), error);
    if (error || size != sizeof header + header.words * sizeof(uint32_t)) return std::nullopt;
    Spirv spirv(header.words);
    if (!file.read(reinterpret_cast<char*>(spirv.data()),
                   static_cast<std::streamsize>(header.words * sizeof(uint32_t))))
        return std::nullopt;
    if (checksum_of(spirv) != header.checksum) return std::nullopt;
    return spirv;
}

void ShaderCache::store(const ContentHash& key, const Spirv& spirv) const {
    if (folder_.empty()) return;
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    static std::atomic<unsigned> counter{0};
    const auto temporary = folder_ / fmt::format("tmp.{}.{}", getpid(), counter++);
    {
        std::ofstream file(temporary, std::ios::binary);
        const Header header{kMagic, spirv.size(), checksum_of(spirv)};
        file.write(reinterpret_cast<const char*>(&header), sizeof header);
        file.write(reinterpret_cast<const char*>(spirv.data()),
                   static_cast<std::streamsize>(spirv.size() * sizeof(uint32_t)));
        file.close();
        if (!file) {
            std::filesystem::remove(temporary, error);
            return;
        }
    }
    std::filesystem::rename(temporary, path(key), error);
    if (error) std::filesystem::remove(temporary, error);
}

}  // namespace lampyris::vulkan

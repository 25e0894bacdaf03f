// Compiled kernels on disk (SPIR-V, machine code), keyed by content. A damaged entry, or one that belongs to another key, is found by its checksum and made again;
// so is one that another user could have written.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris::shaders {

// 128 bits of FNV-1a with a final mix: wide enough that an accidental collision can be ruled out.
class ContentHash {
 public:
    void add(std::string_view bytes);
    void add(uint64_t value);
    std::array<uint64_t, 2> value() const;

 private:
    uint64_t a_ = 0xcbf29ce484222325u, b_ = 0x84222325cbf29ce4u;
};

using Words = std::vector<uint32_t>;

class ShaderCache {
 public:
    // An empty folder switches the cache off. The folder is made when something is stored.
    explicit ShaderCache(std::filesystem::path folder, std::string extension = ".spv")
        : folder_(std::move(folder)), extension_(std::move(extension)) {}

    std::optional<Words> find(const ContentHash& key) const;
    // Readers see all of the file or nothing. Failure to write is not an error: the cache only saves time.
    void store(const ContentHash& key, const Words& words) const;
    std::filesystem::path path(const ContentHash& key) const;

 private:
    std::filesystem::path folder_;
    std::string extension_;
};

}  // namespace lampyris::shaders

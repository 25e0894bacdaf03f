// SPIR-V on disk, keyed by content. A damaged entry, or one that belongs to another key, is found by its checksum and made again.
#pragma once

#include "backends/vulkan/spirv.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>

namespace lampyris::vulkan {

// 128 bits of FNV-1a with a final mix: wide enough that an accidental collision can be ruled out.
class ContentHash {
 public:
    void add(std::string_view bytes);
    void add(uint64_t value);
    std::array<uint64_t, 2> value() const;

 private:
    uint64_t a_ = 0xcbf29ce484222325u, b_ = 0x84222325cbf29ce4u;
};

class ShaderCache {
 public:
    // An empty folder switches the cache off. The folder is made when something is stored.
    explicit ShaderCache(std::filesystem::path folder) : folder_(std::move(folder)) {}
    // $XDG_CACHE_HOME/lampyris, or ~/.cache/lampyris; empty if neither is known.
    static std::filesystem::path default_folder();

    std::optional<Spirv> find(const ContentHash& key) const;
    // Readers see all of the file or nothing. Failure to write is not an error: the cache only saves time.
    void store(const ContentHash& key, const Spirv& spirv) const;
    std::filesystem::path path(const ContentHash& key) const;

 private:
    std::filesystem::path folder_;
};

}  // namespace lampyris::vulkan

// A file of the shader cache with any content is taken for no kernel, unless it is the one that was stored; and any words are searched
// for bindings without harm.
#include "backends/shaders/shader_cache.h"

#include <unistd.h>

#include <cassert>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

using namespace lampyris::shaders;

namespace {

struct Folder {
    std::string path =
        (std::filesystem::temp_directory_path() / ("lampyris-fuzz-" + std::to_string(getpid()))).string();
    Folder() { std::filesystem::create_directory(path); }
    ~Folder() { std::filesystem::remove_all(path); }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const Folder folder;
    const ShaderCache cache(folder.path);
    ContentHash key;
    key.add("fuzz");
    const std::filesystem::path file = cache.path(key);
    std::ofstream(file, std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char*>(data), std::streamsize(size));
    assert(!cache.find(key));

    Spirv words(size / sizeof(uint32_t));
    if (!words.empty()) std::memcpy(words.data(), data, words.size() * sizeof(uint32_t));
    used_bindings(words);
    forbid_contraction(words);
    if (size % 64 == 0) {  // writing is slow
        cache.store(key, words);
        assert(cache.find(key) == words);
        ContentHash other;
        other.add("other");
        std::filesystem::rename(file, cache.path(other));
        assert(!cache.find(other));
    }
    return 0;
}

#include "core/base/plugin.h"

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/registry.h"
#include "core/plugin_abi.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

namespace lampyris {
namespace {

namespace fs = std::filesystem;
constexpr const char* kSymbol = "lampyris_plugin_abi";  // its text in the file: "lampyris_plugin_abi=0.1.0 (hash)"

// Static initializers run inside dlopen, so a plugin's ABI is read from the file's bytes before that.
std::string read_abi(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw InputError(fmt::format("{}: error: cannot read this plugin", file));
    std::string bytes(4, '\0');
    if (!stream.read(bytes.data(), 4) || bytes != "\177ELF")
        throw InputError(fmt::format("{}: error: this is no shared object", file));
    const std::string mark = std::string(kSymbol) + "=";  // put together here: only plugins contain it whole
    // Block by block, with an overlap that holds the whole text. The rest of the largest libraries is debugging information.
    constexpr size_t kBlock = size_t(1) << 20, kMost = size_t(256) << 20, kOverlap = 1024;
    size_t at = std::string::npos;
    for (size_t done = 0; done < kMost && stream && at == std::string::npos; done += kBlock) {
        bytes.erase(0, bytes.size() - std::min(bytes.size(), kOverlap));
        const size_t kept = bytes.size();
        bytes.resize(kept + kBlock);
        stream.read(bytes.data() + kept, std::streamsize(kBlock));
        bytes.resize(kept + size_t(stream.gcount()));
        at = bytes.find(mark);
        // Its end may be in the next block, which then has its beginning, too.
        if (at != std::string::npos && stream && bytes.size() - at < kOverlap) at = std::string::npos;
    }
    if (at == std::string::npos)
        throw InputError(
            fmt::format("{}: error: this shared object is no Lampyris plugin: it has no symbol "
                        "{}; lampyris_add_plugin() in CMake makes it",
                        file, kSymbol));
    constexpr size_t kLongest = 200;
    const std::string abi = bytes.substr(at + mark.size(), kLongest);
    return abi.substr(0, abi.find('\0'));
}

}  // namespace

std::string_view plugin_abi() { return LAMPYRIS_PLUGIN_ABI; }

void load_plugin(const std::string& file) {
    std::error_code failed;
    if (!fs::exists(file, failed)) throw InputError(fmt::format("{}: error: there is no such plugin file", file));
    if (const std::string why = why_not_readable(file); !why.empty())
        throw InputError(fmt::format("{}: error: {}; a plugin is a shared object (.so)", file, why));
    // dlopen searches the system's folders for a name without a slash; hence the full path.
    const std::string path = fs::canonical(file).string();
    static std::set<std::string> loaded;
    if (loaded.contains(path)) return;

    const std::string abi = read_abi(path);
    if (abi != plugin_abi())
        throw InputError(
            fmt::format("{}: error: this plugin was built for Lampyris {}, and this is Lampyris {}; "
                        "build it again",
                        file, shown(abi), plugin_abi()));
    // Never closed: registries and kernels keep pointers into it.
    if (!dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) throw InputError(fmt::format("{}: error: {}", file, dlerror()));
    loaded.insert(path);
    check_registrations();
}

void load_plugin_path(std::string_view list) {
    while (!list.empty()) {
        const std::string entry{list.substr(0, list.find(':'))};
        list.remove_prefix(std::min(entry.size() + 1, list.size()));
        if (entry.empty()) continue;
        std::error_code failed;
        if (!fs::is_directory(entry, failed)) {
            load_plugin(entry);
            continue;
        }
        std::vector<std::string> files;
        for (const fs::directory_entry& found : fs::directory_iterator(entry, failed))
            if (found.path().extension() == ".so") files.push_back(found.path().string());
        if (failed)
            throw InputError(fmt::format("{}: error: cannot read this folder of plugins: {}", entry, failed.message()));
        std::sort(files.begin(), files.end());
        for (const std::string& file : files) load_plugin(file);
    }
}

void load_plugins(const std::vector<std::string>& files) {
    if (const char* path = std::getenv("LAMPYRIS_PLUGIN_PATH")) load_plugin_path(path);
    for (const std::string& file : files) load_plugin(file);
}

}  // namespace lampyris

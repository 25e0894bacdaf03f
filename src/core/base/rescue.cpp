#include "core/base/rescue.h"

#include "core/base/error.h"
#include "core/base/file.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <random>
#include <set>
#include <vector>

namespace lampyris {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> folders() {
    std::vector<std::string> found;
    std::set<std::string> seen;
    const auto add = [&](const char* folder) {
        std::error_code ignored;
        if (folder && *folder && fs::is_directory(folder, ignored) && seen.insert(folder).second)
            found.emplace_back(folder);
    };
    add(std::getenv("TMPDIR"));
    for (const char* folder : {"/tmp", "/var/tmp"}) add(folder);
    add(std::getenv("HOME"));
    add(".");
    return found;
}

}  // namespace

void write_file_or_rescue(const std::string& path, std::span<const std::byte> bytes, const std::string& what) {
    try {
        write_file_atomically(path, bytes);
    } catch (const MachineError& failure) {
        std::random_device random;
        const std::string name =
            fmt::format("lampyris-{:08x}{:08x}{}", random(), random(), fs::path(path).extension().string());
        for (const std::string& folder : folders()) {
            const std::string saved = (fs::path(folder) / name).string();
            try {
                write_file_atomically(saved, bytes);
            } catch (const std::exception&) {
                continue;
            }
            throw MachineError(fmt::format("{}; the {} was saved as '{}'", failure.what(), what, saved));
        }
        throw MachineError(fmt::format("{} (and the {} could not be saved in any folder for temporary files either)",
                                       failure.what(), what));
    }
}

}  // namespace lampyris

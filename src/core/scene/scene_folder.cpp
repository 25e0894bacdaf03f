#include "core/scene/scene_folder.h"

#include "core/base/file.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

namespace lampyris {
namespace {

namespace fs = std::filesystem;

bool is_below(std::string_view path, std::string_view root) {
    if (!path.starts_with(root)) return false;
    return path.size() == root.size() || root.ends_with('/') || path[root.size()] == '/';
}

// Whether a path, read from left to right, is at any time in a folder that is neither below one of the roots nor above it. What comes of
// "../other/file/../../mine" would tell whether there is such a file.
bool strays(const fs::path& path, const std::vector<std::string>& roots) {
    fs::path place;
    for (const fs::path& name : path) {
        if (name == "..")
            place = place.parent_path();
        else if (name != "." && !name.empty())
            place /= name;
        std::string now = place.string();
        const auto holds = [&](const std::string& root) { return is_below(now, root); };
        std::error_code error;
        if (std::any_of(roots.begin(), roots.end(), holds) && fs::is_symlink(place, error)) {
            now = real_path(place);
            place = now;
        }
        const auto touches = [&](const std::string& root) { return is_below(now, root) || is_below(root, now); };
        if (std::none_of(roots.begin(), roots.end(), touches)) return true;
    }
    return false;
}

}  // namespace

SceneFolder::SceneFolder(std::string folder, std::vector<std::string> allowed)
    : name_(folder.empty() ? "." : std::move(folder)) {
    roots_.push_back(real_path(name_));
    for (const std::string& more : allowed) roots_.push_back(real_path(more));
    for (std::string& root : roots_)
        if (root.size() > 1 && root.ends_with('/')) root.pop_back();
    std::erase(roots_, "");
    // As they are called, too: with links in the way.
    ways_ = roots_;
    std::error_code error;
    ways_.push_back(fs::absolute(name_, error).lexically_normal().string());
    for (const std::string& more : allowed) ways_.push_back(fs::absolute(more, error).lexically_normal().string());
    for (std::string& way : ways_)
        if (way.size() > 1 && way.ends_with('/')) way.pop_back();
}

std::string SceneFolder::path(const std::string& name) const { return (fs::path(name_) / name).string(); }

std::string SceneFolder::why_refused(const std::string& path) const {
    std::error_code error;
    const std::string within = name_ + "/";
    const fs::path way = path.starts_with(within) && !roots_.empty() ? fs::path(roots_[0]) / path.substr(within.size())
                                                                     : fs::absolute(path, error);
    const std::string place = strays(way, ways_) ? std::string() : real_path(path);
    const auto holds = [&](const std::string& root) { return is_below(place, root); };
    if (!place.empty() && std::any_of(roots_.begin(), roots_.end(), holds)) return {};
    return "it is outside of the scene's folder; --allow FOLDER lets a scene read files elsewhere, too";
}

}  // namespace lampyris

// Plugins that live in shared objects of their own: what registers itself there joins what is built in. A plugin built
// against other headers than this library's is refused before any of its code runs; see docs/plugin-guide.md.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

// Loads a shared object made by lampyris_add_plugin. A file that was loaded before is not loaded again. Throws InputError
// where the file is missing, is no plugin, was built for another Lampyris, cannot be loaded or registers a name twice.
void load_plugin(const std::string& file);

// Loads what a PATH-like list (LAMPYRIS_PLUGIN_PATH) names: files, and folders, of which every *.so in order of name.
// Throws as load_plugin does.
void load_plugin_path(std::string_view list);

// What a command loads before it looks anything up: LAMPYRIS_PLUGIN_PATH of the environment, then the files of --plugin.
void load_plugins(const std::vector<std::string>& files);

// What this library asks of a plugin's `lampyris_plugin_abi`: the version, and a hash of the headers it was built with.
std::string_view plugin_abi();

}  // namespace lampyris

// Plugins in shared objects of their own: their code registers itself beside the built-in plugins. A plugin that was built
// against other headers than this library's is refused before any of its code runs; see docs/plugin-guide.md.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

// Loads a shared object made by lampyris_add_plugin. A file that was loaded before is not loaded again. Throws InputError if
// the file is missing, is not a plugin, was built for another Lampyris, cannot be loaded or registers a name twice.
void load_plugin(const std::string& file);

// Loads the entries of a PATH-like list (LAMPYRIS_PLUGIN_PATH): files, and folders, from which every *.so is loaded in order of
// name.
// Throws as load_plugin does.
void load_plugin_path(std::string_view list);

// What a command loads before any look-up by name: LAMPYRIS_PLUGIN_PATH of the environment, then the files of --plugin.
void load_plugins(const std::vector<std::string>& files);

// The value of `lampyris_plugin_abi` that this library requires: the version, and a hash of the headers that the plugin was
// built with.
std::string_view plugin_abi();

}  // namespace lampyris

// Which files a scene may read (docs/strangers.md).
#pragma once

#include <string>
#include <vector>

namespace lampyris {

// The folder of a scene's file: relative names start there, and files in it, and below it, may be read; so may those of further
// folders that the user allows. Links are followed before that is judged, so that a link which came with the scene leads nowhere
// else.
class SceneFolder {
 public:
    SceneFolder(std::string folder = ".", std::vector<std::string> allowed = {});  // NOLINT: a folder's name will do

    const std::string& name() const { return name_; }
    // The path of a file that the scene names.
    std::string path(const std::string& name) const;
    // Nothing if the file may be read, or written; else the reason. It is the same whether there is such a file or not.
    std::string why_refused(const std::string& path) const;

 private:
    std::string name_;
    std::vector<std::string> roots_;  // canonical
    std::vector<std::string> ways_;   // absolute: those, and how they were called
};

}  // namespace lampyris

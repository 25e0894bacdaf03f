// A folder for one test: tests run in parallel, each in a process of its own, and two builds may run them at the same time.
#pragma once

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace lampyris::test {

// Created empty, under a unique name; removed with everything in it.
class TemporaryFolder {
 public:
    TemporaryFolder() {
        // mkdtemp puts a name that is free in place of the six letters.
        std::string name = (std::filesystem::temp_directory_path() / ("lampyris-test-" + std::string(6, 'X'))).string();
        if (!mkdtemp(name.data()))
            throw std::filesystem::filesystem_error("mkdtemp", name, std::error_code(errno, std::generic_category()));
        path_ = name;
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() {
        std::error_code ignored;  // a destructor does not throw
        std::filesystem::remove_all(path_, ignored);
    }
    const std::filesystem::path& path() const { return path_; }
    std::string string() const { return path_.string(); }
    // The path of a file in it.
    std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
    std::filesystem::path path_;
};

}  // namespace lampyris::test

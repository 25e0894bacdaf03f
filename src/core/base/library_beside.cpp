#include "core/base/library_beside.h"

#include <dlfcn.h>
#include <elf.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

namespace lampyris {
namespace {

// The loader maps a library's parts without a look at the file's size: to touch one that is not there ends the process. Nothing if
// all parts are there, or the file is none that the loader would map.
std::string what_is_missing(const std::string& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) return {};
    if (!std::filesystem::is_regular_file(status)) return path + " is no regular file";
    const uint64_t size = std::filesystem::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    Elf64_Ehdr header{};
    if (!file.read(reinterpret_cast<char*>(&header), sizeof header)) return path + " is damaged: it ends too early";
    if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_phentsize != sizeof(Elf64_Phdr)) return {};
    std::vector<Elf64_Phdr> parts(header.e_phnum);
    file.seekg(std::streamoff(header.e_phoff));
    if (!file.read(reinterpret_cast<char*>(parts.data()), std::streamsize(parts.size() * sizeof(Elf64_Phdr))))
        return path + " is damaged: it ends too early";
    for (const Elf64_Phdr& part : parts)
        if (part.p_type == PT_LOAD && (part.p_offset > size || part.p_filesz > size - part.p_offset))
            return path + " is damaged: it ends too early";
    return {};
}

}  // namespace

void* function_of_library_beside(const char* library, const char* function, std::string& why) {
    Dl_info here{};
    dladdr(reinterpret_cast<const void*>(&function_of_library_beside), &here);
    const std::string path =
        (std::filesystem::path(here.dli_fname ? here.dli_fname : "").parent_path() / library).string();
    why = what_is_missing(path);
    if (!why.empty()) return nullptr;
    void* const loaded = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    void* const found = loaded ? dlsym(loaded, function) : nullptr;
    if (!found) why = dlerror();
    return found;
}

}  // namespace lampyris

#include "core/image/exr_header.h"

#include "core/base/error.h"

#include <fmt/format.h>
#include <OpenEXR/openexr.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

namespace lampyris {
namespace {

thread_local std::string last_error;

void keep_error(exr_const_context_t, exr_result_t, const char* message) { last_error = message; }

struct Context {
    explicit Context(const std::string& path) {
        exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
        settings.error_handler_fn = keep_error;
        last_error.clear();
        result = exr_start_read(&handle, path.c_str(), &settings);
    }
    ~Context() { exr_finish(&handle); }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    exr_context_t handle = nullptr;
    exr_result_t result = EXR_ERR_SUCCESS;
};

// Up to a zero byte, which is read, too.
std::string read_name(std::ifstream& file) {
    std::string name;
    std::getline(file, name, '\0');
    return name;
}

// The list of channels ends with an empty name, and has to end where its attribute does: the two libraries go on reading from
// different places otherwise.
void check_channels(std::ifstream& file, std::streamoff bytes) {
    constexpr std::streamoff kChannel = 16;  // after its name: type, linearity, sampling
    constexpr int kMostChannels = 8192;      // OpenEXR takes seconds for tens of thousands
    const std::streamoff end = std::streamoff(file.tellg()) + bytes;
    for (int channels = 0; file && !read_name(file).empty(); ++channels) {
        if (channels == kMostChannels)
            throw InputError(fmt::format("it has more than {} channels, which are not read", kMostChannels));
        file.seekg(kChannel, std::ios::cur);
    }
    if (!file || std::streamoff(file.tellg()) != end)
        throw InputError("its header is damaged: the list of channels has another length than it says");
}

// Values of these types have one size, which the C++ interface reads, whatever the attribute says of its length.
const std::map<std::string, int32_t>& sizes_of_types() {
    static const std::map<std::string, int32_t> sizes{{"box2f", 16},
                                                      {"box2i", 16},
                                                      {"chromaticities", 32},
                                                      {"compression", 1},
                                                      {"deepImageState", 1},
                                                      {"double", 8},
                                                      {"envmap", 1},
                                                      {"float", 4},
                                                      {"int", 4},
                                                      {"keycode", 28},
                                                      {"lineOrder", 1},
                                                      {"m33d", 72},
                                                      {"m33f", 36},
                                                      {"m44d", 128},
                                                      {"m44f", 64},
                                                      {"rational", 8},
                                                      {"tiledesc", 9},
                                                      {"timecode", 8},
                                                      {"v2d", 16},
                                                      {"v2f", 8},
                                                      {"v2i", 8},
                                                      {"v3d", 24},
                                                      {"v3f", 12},
                                                      {"v3i", 12}};
    return sizes;
}

// A preview is its width and height, and four bytes for each pixel.
bool is_preview(std::ifstream& file, int32_t bytes) {
    uint32_t sides[2] = {};
    return bytes >= 8 && file.read(reinterpret_cast<char*>(sides), sizeof sides) && sides[0] <= 0xffffu &&
           sides[1] <= 0xffffu && 8 + 4 * uint64_t(sides[0]) * sides[1] == uint64_t(bytes);
}

// A list of texts, each after its length.
bool is_list_of_texts(std::ifstream& file, int32_t bytes) {
    int64_t left = bytes;
    while (left > 0) {
        int32_t length = 0;
        if (!file.read(reinterpret_cast<char*>(&length), sizeof length) || length < 0) return false;
        left -= 4 + int64_t(length);
        file.seekg(length, std::ios::cur);
    }
    return left == 0;
}

// The C++ interface reads on where a value ends, which has to be where its attribute does.
void check_value(std::ifstream& file, const std::string& name, const std::string& type, int32_t bytes) {
    if (type == "chlist") return check_channels(file, bytes);
    const auto known = sizes_of_types().find(type);
    if ((known != sizes_of_types().end() && known->second != bytes) ||
        (type == "preview" && !is_preview(file, bytes)) || (type == "stringvector" && !is_list_of_texts(file, bytes)))
        throw InputError(fmt::format("its header is damaged: the attribute '{}' of type '{}' is said to have {} bytes",
                                     name, type, bytes));
}

// Names and types of a header's attributes end with a zero byte; a length of four bytes and the value follow.
void check_attributes(const std::string& path, int64_t size) {
    std::ifstream file(path, std::ios::binary);
    file.seekg(8);  // magic number and version
    for (std::string name = read_name(file); !name.empty(); name = read_name(file)) {
        const std::string type = read_name(file);
        int32_t bytes = 0;
        if (!file.read(reinterpret_cast<char*>(&bytes), sizeof bytes)) break;
        const int64_t left = size - int64_t(file.tellg());
        if (bytes < 0 || bytes > left)
            throw InputError(
                fmt::format("its header is damaged: the attribute '{}' is said to have {} bytes, and {} follow", name,
                            bytes, left));
        const std::streamoff next = std::streamoff(file.tellg()) + bytes;
        check_value(file, name, type, bytes);
        file.seekg(next);
    }
    if (!file) throw InputError("its header is damaged: it does not end");
}

}  // namespace

void check_exr_header(const std::string& path) {
    const auto size = int64_t(std::filesystem::file_size(path));
    check_attributes(path, size);
    const Context context(path);
    int32_t chunks = 0;
    if (context.result != EXR_ERR_SUCCESS || exr_get_chunk_count(context.handle, 0, &chunks) != EXR_ERR_SUCCESS)
        throw InputError(fmt::format("its header is damaged{}{}", last_error.empty() ? "" : ": ", last_error));
    // The file has the place of each in eight bytes.
    if (8 * int64_t(chunks) > size)
        throw InputError(
            fmt::format("its header says {} tiles or blocks of lines, but the file has only {} bytes", chunks, size));
}

}  // namespace lampyris

// Any bytes are an image, with as many numbers as it says, or an InputError.
#include "core/base/error.h"
#include "core/image/image_io.h"
#include "memory_file.h"

#include <cassert>

using namespace lampyris;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const MemoryFile file(data, size);
    try {
        const Image image = read_image(file.path(), {.linear = size % 2 == 0, .rgb = size % 3 == 0});
        assert(image.width > 0 && image.height > 0 && image.channels > 0);
        assert(image.pixels.size() == image.pixel_count() * size_t(image.channels));
        assert(image.channel_names.size() == size_t(image.channels));
    } catch (const InputError&) {}
    return 0;
}

// Any bytes, with the right hash behind them, are a checkpoint or an InputError.
#include "core/base/error.h"
#include "core/render/checkpoint.h"
#include "memory_file.h"

#include <cassert>
#include <cstring>
#include <span>
#include <vector>

using namespace lampyris;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    std::vector<uint8_t> bytes(data, data + size);
    if (size >= 8) {  // of a seed, the last eight bytes are a hash
        const uint64_t hash = checkpoint_hash(std::as_bytes(std::span(bytes).first(size - 8)));
        std::memcpy(bytes.data() + size - 8, &hash, 8);
    }
    const MemoryFile file(bytes.data(), bytes.size());
    try {
        const auto checkpoint = read_checkpoint(file.path());
        assert(checkpoint);
        check_same_rendering("fuzz", checkpoint->identity, checkpoint->identity);
    } catch (const InputError&) {}
    return 0;
}

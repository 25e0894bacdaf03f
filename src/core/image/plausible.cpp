#include "core/image/plausible.h"

#include "core/base/error.h"
#include "core/base/memory.h"

#include <fmt/format.h>

#include <filesystem>

namespace lampyris {

void check_plausible(const std::string& path, int64_t width, int64_t height, int64_t channels, int64_t value_bytes,
                     uint64_t max_memory) {
    // A header that promises far more than the file can hold is damaged or hostile; trusting it would exhaust memory. No format
    // here packs more than about 8000 to 1 (deflate's 1032, times eight for one-bit pixels).
    constexpr double kFree = double(2 << 20), kMostPacked = 20000.0;
    const double values = double(width) * double(height) * double(channels);
    const double promised = values * double(value_bytes);
    const uint64_t held = uint64_t(std::filesystem::file_size(path));
    if (promised > kFree && promised / kMostPacked > double(held))
        throw InputError(fmt::format("its header says {}x{} pixels of {} channels, but the file has only {} bytes",
                                     width, height, channels, held));
    // The pixels as floats, plus their packed form.
    const double needed = 2.0 * sizeof(float) * values;
    if (needed > double(machine_memory()))
        throw InputError(
            fmt::format("{}x{} pixels of {} channels need {:.1f} GB, and this machine has {:.1f} GB of memory", width,
                        height, channels, needed * 1e-9, double(machine_memory()) * 1e-9));
    if (max_memory > 0 && needed + double(process_memory()) > double(max_memory))
        throw MachineError(
            fmt::format("error: the image '{}' has {}x{} pixels of {} channels, which need {} MiB, and --max-memory "
                        "allows {} MiB for the whole program",
                        path, width, height, channels, uint64_t(needed) >> 20, max_memory >> 20));
}

}  // namespace lampyris

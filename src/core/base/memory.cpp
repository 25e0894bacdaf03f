#include "core/base/memory.h"

#include "core/base/error.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace lampyris {

uint64_t machine_memory() {
    static const uint64_t bytes = [] {
        uint64_t most = std::numeric_limits<uint64_t>::max();
        const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
        if (pages > 0 && page > 0) most = uint64_t(pages) * uint64_t(page);
        // Control groups, versions 2 and 1; without a limit the files contain "max", or a number beyond the machine's memory.
        for (const char* path : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
            std::ifstream file(path);
            uint64_t limit = 0;
            if (file >> limit && limit > 0) most = std::min(most, limit);
        }
        return most;
    }();
    return bytes;
}

uint64_t process_memory() {
    std::ifstream status("/proc/self/status");
    uint64_t kibibytes = 0;
    for (std::string name; status >> name; status.ignore(std::numeric_limits<std::streamsize>::max(), '\n')) {
        uint64_t value = 0;
        if ((name == "RssAnon:" || name == "RssShmem:") && status >> value) kibibytes += value;
    }
    return kibibytes * 1024;
}

void check_process_memory(uint64_t most) {
    const uint64_t now = most ? process_memory() : 0;
    if (now <= most) return;
    throw MachineError(
        fmt::format("error: the program has {} MiB of memory, and --max-memory allows {} MiB", now >> 20, most >> 20));
}

}  // namespace lampyris

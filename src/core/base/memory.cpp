#include "core/base/memory.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>

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

}  // namespace lampyris

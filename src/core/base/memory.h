// How much memory there is, so that requests that cannot fit are refused before the system kills the process.
#pragma once

#include <cstdint>

namespace lampyris {

// Bytes of the machine, or of the process's container if that has a limit.
uint64_t machine_memory();

// Bytes of memory that this process has written to: not the code of libraries, nor files that it maps. 0 if the system does not tell.
uint64_t process_memory();
// Throws MachineError if the process has more than `most`; 0: no limit.
void check_process_memory(uint64_t most);

}  // namespace lampyris

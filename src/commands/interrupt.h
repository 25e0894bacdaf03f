// Ctrl-C, SIGTERM and a hangup while a scene is rendered.
#pragma once

#include "core/base/watch.h"

#include <string>
#include <vector>

namespace lampyris {

// During its lifetime, a signal ends the program at once, whatever it is doing, as long as there is nothing to write: the exit
// code is 130, and an older image stays as it was. Once there is something to write, the first signal requests the end of the
// rendering, and the finished part is written; a second signal ends the program at once.
class InterruptWatch {
 public:
    InterruptWatch(std::vector<std::string> outputs, Watch& rendering);
    ~InterruptWatch();
    InterruptWatch(const InterruptWatch&) = delete;
    InterruptWatch& operator=(const InterruptWatch&) = delete;

    void set_outputs(std::vector<std::string> outputs);
    // From now on there is an image to write.
    void image_begins();
};

}  // namespace lampyris

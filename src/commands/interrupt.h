// Ctrl-C, SIGTERM and a hangup while a scene is rendered.
#pragma once

#include "core/watch.h"

#include <string>
#include <vector>

namespace lampyris {

// While it lives, a signal ends the program at once, whatever it is doing, as long as there is nothing to write: exit code 130, and
// an older image stays as it was. Once there is something, the first signal asks the rendering to end, and what is done is
// written; the second one ends the program.
class InterruptWatch {
 public:
    InterruptWatch(std::vector<std::string> outputs, Watch& rendering);
    ~InterruptWatch();
    InterruptWatch(const InterruptWatch&) = delete;
    InterruptWatch& operator=(const InterruptWatch&) = delete;

    void set_outputs(std::vector<std::string> outputs);
    // From now on there is something to write.
    void image_begins();
};

}  // namespace lampyris

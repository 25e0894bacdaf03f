// Ctrl-C, SIGTERM and a hangup while a scene is rendered.
#pragma once

#include "core/base/watch.h"

#include <functional>
#include <string>
#include <vector>

namespace lampyris {

// During its lifetime, a signal ends the program at once, whatever it is doing, as long as there is nothing to write: the exit
// code is 130, and an older image stays as it was. Once there is something to write, the first signal requests the end of the
// rendering, and the finished part is written; a second signal ends the program at once. If the rendering does not end within
// 1.5 seconds, because it is in a driver's compiler, or waits for a device that hangs, what there was after its last look at the
// film is written meanwhile, and the program ends.
class InterruptWatch {
 public:
    // write_so_far is called by another thread, and returns the last message of the program.
    InterruptWatch(std::vector<std::string> outputs, Watch& rendering, std::function<std::string()> write_so_far);
    ~InterruptWatch();
    InterruptWatch(const InterruptWatch&) = delete;
    InterruptWatch& operator=(const InterruptWatch&) = delete;

    void set_outputs(std::vector<std::string> outputs);
    // From now on there is an image to write.
    void image_begins();
    // The rendering has ended, and writes its image itself.
    void writing_begins();
    // It has written it: after a signal, the program ends even if nobody reads its last messages.
    void written();
};

}  // namespace lampyris

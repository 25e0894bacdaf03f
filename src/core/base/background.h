// Work beside the caller's, one task after the other, on a thread of its own: what a program can do without, and need not wait for.
#pragma once

#include <functional>

namespace lampyris {

// Exit waits for the task that has begun. To be called where tasks are given, on the thread that started the process if possible: where
// that thread ends the process, no static object is destroyed before the task is over, also none that the task makes or that belongs to
// libraries it loads. Where another thread calls exit, only objects made before this call are safe.
void wait_for_background_at_exit();

// The task must not throw. It may not be done: when the process exits, tasks that have not begun are dropped, and so are
// all while the system has no thread to spare.
void run_in_background(std::function<void()> task);

// Waits until no task is left, or for so many seconds. False if one is left: who does not want to wait any longer has to leave by _exit.
bool background_ends_within(double seconds);

}  // namespace lampyris

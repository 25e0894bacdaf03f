// Work beside the caller's, one task after the other, on a thread of its own: what a program can do without, and need not wait for.
#pragma once

#include <functional>

namespace lampyris {

// The task must not throw. It may not be done: when the process exits, tasks that have not begun are dropped. Exit waits for the one
// that has, as it may use objects that are destroyed then.
void run_in_background(std::function<void()> task);

// Lets exit wait also where libraries that tasks use were loaded after the first task was given: before these are destroyed.
void wait_for_background_at_exit();

// Waits until no task is left, or for so many seconds. False if one is left: who does not want to wait any longer has to leave by _exit.
bool background_ends_within(double seconds);

}  // namespace lampyris

#include "core/base/background.h"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

namespace lampyris {
namespace {

struct Background {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<std::function<void()>> tasks;
    bool busy = false, started = false, exiting = false;

    void loop() {
        std::unique_lock lock(mutex);
        for (;;) {
            changed.wait(lock, [&] { return !tasks.empty(); });
            const std::function<void()> task = std::move(tasks.front());
            tasks.pop_front();
            busy = true;
            lock.unlock();
            task();
            lock.lock();
            busy = false;
            changed.notify_all();
        }
    }
};

// Never destroyed: the thread waits for tasks as long as the process lives.
Background& background() {
    static Background& one = *new Background;
    return one;
}

void drop_and_wait() {
    Background& b = background();
    std::unique_lock lock(b.mutex);
    b.exiting = true;
    b.tasks.clear();
    b.changed.wait(lock, [&] { return !b.busy; });
}

// exit destroys the calling thread's objects before any static one. Static objects, in turn, are destroyed in the opposite order of
// their making: those that a running task made would be the first.
struct WaitsBeforeStatics {
    bool starter = gettid() == getpid();
    ~WaitsBeforeStatics() {
        if (starter) drop_and_wait();
    }
};

}  // namespace

void wait_for_background_at_exit() {
    thread_local const WaitsBeforeStatics waits;
    static const bool registered = std::atexit(&drop_and_wait) == 0;
    (void)waits, (void)registered;
}

void run_in_background(std::function<void()> task) {
    Background& b = background();
    const std::lock_guard lock(b.mutex);
    if (b.exiting) return;
    if (!b.started) {
        try {
            std::thread([&b] { b.loop(); }).detach();
        } catch (const std::system_error&) {
            return;
        }
        b.started = true;
    }
    b.tasks.push_back(std::move(task));
    b.changed.notify_all();
}

bool background_ends_within(double seconds) {
    Background& b = background();
    std::unique_lock lock(b.mutex);
    return b.changed.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return !b.busy && b.tasks.empty(); });
}

}  // namespace lampyris

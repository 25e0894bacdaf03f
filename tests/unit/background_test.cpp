// A task that still runs when the process exits may use static objects to its end, also those that it makes itself, as libraries that
// it loads do.
#include "core/base/background.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <thread>

namespace lampyris {
namespace {

std::atomic<bool> made{false}, destroyed{false};

struct Used {
    Used() { made = true; }
    ~Used() { destroyed = true; }
};

// Exit code 3 if the object of the task is destroyed while the task runs.
void uses_static_object() {
    static const Used used;
    for (int i = 0; i < 100; ++i) {
        if (destroyed) _exit(3);
        std::this_thread::sleep_for(std::chrono::milliseconds(3));
    }
}

[[noreturn]] void exit_during_task() {
    wait_for_background_at_exit();
    run_in_background(&uses_static_object);
    while (!made) std::this_thread::yield();
    std::exit(0);
}

TEST(Background, ExitOfTheMainThreadDestroysNothingATaskUses) {
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    EXPECT_EXIT(exit_during_task(), testing::ExitedWithCode(0), "");
}

TEST(Background, TasksThatHaveNotBegunAreDropped) {
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    EXPECT_EXIT(
        {
            wait_for_background_at_exit();
            run_in_background(&uses_static_object);
            run_in_background([] { _exit(4); });
            while (!made) std::this_thread::yield();
            std::exit(0);
        },
        testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace lampyris

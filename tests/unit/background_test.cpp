// A task that still runs when the process exits may use static objects to its end, also those that it makes itself, as libraries that
// it loads do.
#include "core/base/background.h"

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <thread>

namespace {

std::atomic<bool> no_threads{false};

}  // namespace

// Takes the place of the system's, for libraries, too.
extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
                              void* argument) {
    if (no_threads) return EAGAIN;
    static const auto next = reinterpret_cast<decltype(&pthread_create)>(dlsym(RTLD_NEXT, "pthread_create"));
    return next(thread, attributes, start, argument);
}

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

TEST(Background, ASystemWithoutThreadsDropsTasks) {
    no_threads = true;
    run_in_background([] { made = true; });
    EXPECT_TRUE(background_ends_within(0));
    no_threads = false;
    EXPECT_FALSE(made);
    run_in_background([] { made = true; });
    EXPECT_TRUE(background_ends_within(60));
    EXPECT_TRUE(made);
}

}  // namespace
}  // namespace lampyris

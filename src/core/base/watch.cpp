#include "core/base/watch.h"

#include <chrono>

namespace lampyris {
namespace {

// Passes that take less time are finished, because an image with the same number of samples everywhere is better.
constexpr int64_t kPatienceNs = 1'000'000'000;

int64_t now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

Watch*& watch_of_thread() {
    static Watch nobody;
    thread_local Watch* watch = &nobody;
    return watch;
}

}  // namespace

void Watch::interrupt() {
    int64_t never = 0;
    asked_at_.compare_exchange_strong(never, now_ns());
}

void Watch::check_cancelled() const {
    const int64_t since = asked_at_.load(std::memory_order_relaxed);
    if (since != 0 && now_ns() - since > kPatienceNs) throw Cancelled();
}

Watch& current_watch() { return *watch_of_thread(); }

WatchScope::WatchScope(Watch& watch) : outer_(watch_of_thread()) { watch_of_thread() = &watch; }

WatchScope::~WatchScope() { watch_of_thread() = outer_; }

CompileNotice::CompileNotice(std::string_view kernel) : kernel_(kernel) { current_watch().compiling(kernel_, true); }

CompileNotice::~CompileNotice() { current_watch().compiling(kernel_, false); }

}  // namespace lampyris

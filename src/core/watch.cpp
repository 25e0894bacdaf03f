#include "core/watch.h"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <utility>

namespace lampyris {
namespace {

// Passes that take less are finished: an image with the same number of samples everywhere is the better one.
constexpr int64_t kPatienceNs = 1'000'000'000;

int64_t now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

std::atomic<int64_t> asked_at{0};  // 0: not asked

CompileListener& compile_listener() {
    static CompileListener listener;
    return listener;
}

}  // namespace

void request_interrupt() {
    int64_t never = 0;
    asked_at.compare_exchange_strong(never, now_ns());
}

bool interrupt_requested() { return asked_at.load(std::memory_order_relaxed) != 0; }

void check_cancelled() {
    const int64_t since = asked_at.load(std::memory_order_relaxed);
    if (since != 0 && now_ns() - since > kPatienceNs) throw Cancelled();
}

void set_compile_listener(CompileListener listener) { compile_listener() = std::move(listener); }

CompileNotice::CompileNotice(std::string_view kernel) : kernel_(kernel) {
    if (compile_listener()) compile_listener()(kernel_, true);
}

CompileNotice::~CompileNotice() {
    if (compile_listener()) compile_listener()(kernel_, false);
}

}  // namespace lampyris

// Events that a program receives from the library during a call, and the way to end the call early.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <string_view>

namespace lampyris {

class Watch {
 public:
    virtual ~Watch() = default;

    // A device begins to compile a kernel, or has finished or failed. Drivers do not report how far they are.
    virtual void compiling([[maybe_unused]] std::string_view kernel, [[maybe_unused]] bool begins) {}

    // Requests the end of the rendering: after its current slice, or, if that takes longer than a second, in the middle of a
    // kernel. May be called by any thread, and by a signal handler. Before a rendering begins, the request applies to the next
    // one.
    void interrupt();
    // The request has been fulfilled, and does not apply to the next rendering.
    void interruption_ends() { asked_at_.store(0, std::memory_order_relaxed); }
    bool interrupted() const { return asked_at_.load(std::memory_order_relaxed) != 0; }
    // Throws Cancelled if the end was requested at least a second ago. Devices call it between the parts of a kernel's work, in
    // any thread.
    void check_cancelled() const;

 private:
    std::atomic<int64_t> asked_at_{0};  // 0: no request
};

// Thrown by Device::run if it leaves work undone. Kernels write each pixel at once, so the film is still valid, but some pixels
// have one sample more than others.
class Cancelled : public std::exception {
 public:
    const char* what() const noexcept override { return "interrupted"; }
};

// The watch of the call that this thread is executing; outside of any call, one that does nothing.
Watch& current_watch();

// Makes a watch the current one of this thread, for the scope's lifetime.
class WatchScope {
 public:
    explicit WatchScope(Watch& watch);
    ~WatchScope();
    WatchScope(const WatchScope&) = delete;
    WatchScope& operator=(const WatchScope&) = delete;

 private:
    Watch* outer_;
};

// For devices: during its lifetime, this thread's watch shows that a kernel is being compiled.
class CompileNotice {
 public:
    explicit CompileNotice(std::string_view kernel);
    ~CompileNotice();
    CompileNotice(const CompileNotice&) = delete;
    CompileNotice& operator=(const CompileNotice&) = delete;

 private:
    std::string_view kernel_;
};

}  // namespace lampyris

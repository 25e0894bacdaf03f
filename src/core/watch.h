// What a program hears of the library while a call lasts, and how it asks the call to end.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <string_view>

namespace lampyris {

class Watch {
 public:
    virtual ~Watch() = default;

    // A device begins to compile a kernel, or has done so or failed. A driver does not say how far it is.
    virtual void compiling([[maybe_unused]] std::string_view kernel, [[maybe_unused]] bool begins) {}

    // Asks the rendering to end: after its slice, or, where that takes longer than a second, in the middle of a kernel's work.
    // It may be called by any thread, and by a signal handler. Before a rendering begins, it is meant for the next one.
    void interrupt();
    // What was asked is done: the next rendering is not meant.
    void interruption_ends() { asked_at_.store(0, std::memory_order_relaxed); }
    bool interrupted() const { return asked_at_.load(std::memory_order_relaxed) != 0; }
    // Throws Cancelled where the rendering was asked to end a second ago. Devices call it between the parts of a kernel's work,
    // in any thread.
    void check_cancelled() const;

 private:
    std::atomic<int64_t> asked_at_{0};  // 0: not asked
};

// Thrown by Device::run where it leaves work undone. Kernels that render write a pixel at once: the film is as good as before, but
// some pixels have a sample more than others.
class Cancelled : public std::exception {
 public:
    const char* what() const noexcept override { return "interrupted"; }
};

// The watch of the call that this thread is in; outside of all, one that does nothing.
Watch& current_watch();

// Makes a watch this thread's for as long as it lives.
class WatchScope {
 public:
    explicit WatchScope(Watch& watch);
    ~WatchScope();
    WatchScope(const WatchScope&) = delete;
    WatchScope& operator=(const WatchScope&) = delete;

 private:
    Watch* outer_;
};

// For devices: tells this thread's watch that a kernel is compiled, for as long as it lives.
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

// What a program may say to the library while a call lasts, namely that it should end, and hear from it: what takes long.
#pragma once

#include <exception>
#include <functional>
#include <string_view>

namespace lampyris {

// Asks a rendering to end: after its slice, or, where that takes longer than a second, in the middle of a kernel's work. It may be
// asked by any thread, and by a signal handler.
void request_interrupt();
bool interrupt_requested();

// Thrown by Device::run where it leaves work undone. Kernels that render write a pixel at once: the film is as good as before, but
// some pixels have a sample more than others.
class Cancelled : public std::exception {
 public:
    const char* what() const noexcept override { return "interrupted"; }
};

// Devices call it between the parts of a kernel's work: throws Cancelled when it is time.
void check_cancelled();

// Hears when a device begins to compile a kernel, and when it has done so or failed. A driver does not say how far it is.
using CompileListener = std::function<void(std::string_view kernel, bool begins)>;
void set_compile_listener(CompileListener listener);

// For devices: tells the listener for as long as it lives.
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

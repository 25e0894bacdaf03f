#include "commands/compile_display.h"

#include "commands/console.h"
#include "commands/progress.h"
#include "core/device/kernel_registry.h"

#include <unistd.h>

namespace lampyris {
namespace {

using std::chrono::seconds;
constexpr seconds kUnmentioned{2}, kInPlaceInterval{1}, kLogInterval{10};

// "path" of integrators/path/path.radiance.h, "sppm+kd_tree" of a consumer and a structure.
std::string short_name(std::string_view kernel) {
    std::string name;
    for (std::string_view part : kernel_parts(kernel)) {
        if (part == kPixelLoop) continue;
        part.remove_prefix(part.rfind('/') + 1);  // from 0 where there is none
        name += name.empty() ? "" : "+";
        name += part.substr(0, part.find('.'));
    }
    return name;
}

}  // namespace

CompileDisplay::CompileDisplay(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0) {}

CompileDisplay::~CompileDisplay() {
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void CompileDisplay::heard(std::string_view kernel, bool begins) {
    if (quiet_) return;
    const std::lock_guard lock(mutex_);
    if (begins) {
        kernel_ = short_name(kernel);
        start_ = Clock::now();
        if (!thread_.joinable()) thread_ = std::thread([this] { watch(); });
    } else {
        if (mentioned_ && terminal_) tell_in_place("");
        if (mentioned_ && !terminal_) {
            const double spent = std::chrono::duration<double>(Clock::now() - start_).count();
            tell("compiled kernel {} in {}\n", kernel_, duration_text(spent));
        }
        kernel_.clear();
        mentioned_ = false;
    }
    changed_.notify_all();
}

void CompileDisplay::watch() {
    std::unique_lock lock(mutex_);
    while (!ends_) {
        if (kernel_.empty()) {
            changed_.wait(lock);
            continue;
        }
        const seconds spent = std::chrono::duration_cast<seconds>(Clock::now() - start_);
        if (spent >= kUnmentioned) {
            const std::string text = fmt::format("compiling kernel {} for Vulkan, {} s so far", kernel_, spent.count());
            if (terminal_)
                tell_in_place(text);
            else
                tell("{}\n", text);
            mentioned_ = true;
        }
        // The next kernel starts afresh: the thread waits for the end of this one, or for the time of another line.
        const Clock::time_point began = start_;
        const seconds next = !mentioned_ ? kUnmentioned : spent + (terminal_ ? kInPlaceInterval : kLogInterval);
        changed_.wait_until(lock, start_ + next, [&] { return ends_ || kernel_.empty() || start_ != began; });
    }
}

}  // namespace lampyris

#include "commands/interrupt.h"

#include "commands/console.h"
#include "core/base/error.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

namespace lampyris {
namespace {

enum class State { kNothingDone, kImageBegun, kEnding };

// A signal handler may do almost nothing. It wakes a thread, which may do anything, even while the others are in a driver's
// compiler.
int wake[2] = {-1, -1};
std::atomic<State> state{State::kNothingDone};
std::mutex mutex;
std::vector<std::string> outputs;
Watch* rendering = nullptr;
std::thread watcher;

constexpr char kStop = 0;

extern "C" void on_interrupt(int) {
    const int saved = errno;
    const char signal = 1;
    [[maybe_unused]] const ssize_t written = ::write(wake[1], &signal, 1);
    errno = saved;
}

std::string older_images() {
    const std::lock_guard lock(mutex);
    std::vector<std::string> found;
    for (const std::string& output : outputs) {
        std::error_code error;
        if (std::filesystem::is_regular_file(output, error)) found.push_back(fmt::format("'{}'", output));
    }
    if (found.empty()) return {};
    return fmt::format("; {} {} as {} {}", list_of(found), found.size() == 1 ? "is left" : "are left",
                       found.size() == 1 ? "it" : "they", found.size() == 1 ? "was" : "were");
}

[[noreturn]] void end(const std::string& message) {
    tell("{}\n", message);
    std::_Exit(int(ExitCode::kInterrupted));
}

void watch() {
    bool asked = false;
    for (char signal = 0;;) {
        const ssize_t got = ::read(wake[0], &signal, 1);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0 || signal == kStop) return;
        State nothing = State::kNothingDone;
        if (state.compare_exchange_strong(nothing, State::kEnding))
            end("interrupted before a pass was finished: nothing is written" + older_images());
        if (asked) end("interrupted again: ended at once");
        asked = true;
        tell("interrupted: what is done is written\n");
        rendering->interrupt();
    }
}

bool is_ignored(int signal) {
    struct sigaction now {};
    return ::sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

}  // namespace

InterruptWatch::InterruptWatch(std::vector<std::string> names, Watch& watch_of_rendering) {
    set_outputs(std::move(names));
    rendering = &watch_of_rendering;
    if (::pipe2(wake, O_CLOEXEC) != 0) return;  // if this fails, signals have their default effect
    watcher = std::thread(watch);
    std::signal(SIGINT, &on_interrupt);
    std::signal(SIGTERM, &on_interrupt);
    if (!is_ignored(SIGHUP)) std::signal(SIGHUP, &on_interrupt);  // nohup
}

InterruptWatch::~InterruptWatch() {
    if (!watcher.joinable()) return;
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
    if (!is_ignored(SIGHUP)) std::signal(SIGHUP, SIG_DFL);
    [[maybe_unused]] const ssize_t written = ::write(wake[1], &kStop, 1);
    watcher.join();
    for (int& fd : wake) ::close(std::exchange(fd, -1));
}

void InterruptWatch::set_outputs(std::vector<std::string> names) {
    const std::lock_guard lock(mutex);
    outputs = std::move(names);
}

void InterruptWatch::image_begins() {
    State nothing = State::kNothingDone;
    if (state.compare_exchange_strong(nothing, State::kImageBegun) || nothing == State::kImageBegun) return;
    for (;;) ::pause();  // the watcher ends the program
}

}  // namespace lampyris

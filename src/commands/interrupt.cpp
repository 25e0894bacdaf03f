#include "commands/interrupt.h"

#include "commands/console.h"
#include "core/base/error.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

namespace lampyris {
namespace {

using Clock = std::chrono::steady_clock;
enum class State { kNothingDone, kImageBegun, kWriting, kWritten, kEnding };

// A signal handler may do almost nothing. It wakes a thread, which may do anything, even while the others are in a driver's
// compiler.
int wake[2] = {-1, -1};
std::atomic<State> state{State::kNothingDone};
std::mutex mutex;
std::vector<std::string> outputs;
Watch* rendering = nullptr;
std::function<std::string()> write_so_far;
std::thread watcher;
std::atomic<bool> is_busy{false};  // the watcher, with a message that nobody reads, or a slow disk

constexpr char kStop = 0;
constexpr std::chrono::milliseconds kPatience{1500};  // more than Watch::check_cancelled has
constexpr std::chrono::milliseconds kLastWords{500};  // for messages, which may wait for a reader
constexpr int kTickMs = 100;

extern "C" void on_interrupt(int) {
    if (is_busy.load()) ::_exit(int(ExitCode::kInterrupted));
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

bool takes_over(State from) { return state.compare_exchange_strong(from, State::kEnding); }

// Whether there is a signal to read within the time; a negative one is without end.
bool wait_for_signal(int milliseconds) {
    pollfd ready{wake[0], POLLIN, 0};
    int count;
    do count = ::poll(&ready, 1, milliseconds);
    while (count < 0 && errno == EINTR);
    return count != 0;
}

// After the first signal: ends the program if it does not do so by itself.
void check_progress(Clock::time_point asked_at, Clock::time_point& written_at) {
    const Clock::time_point now = Clock::now();
    if (state != State::kWritten) written_at = now;
    if (now - written_at > kLastWords) std::_Exit(int(ExitCode::kInterrupted));
    if (now - asked_at < kPatience || !takes_over(State::kImageBegun)) return;
    is_busy = true;
    end(write_so_far());
}

void watch() {
    std::optional<Clock::time_point> asked_at;
    Clock::time_point written_at;
    for (char signal = 0;;) {
        is_busy = false;
        if (!wait_for_signal(asked_at ? kTickMs : -1)) {
            check_progress(*asked_at, written_at);
            continue;
        }
        const ssize_t got = ::read(wake[0], &signal, 1);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0 || signal == kStop) return;
        is_busy = true;
        if (takes_over(State::kNothingDone))
            end("interrupted before a pass was finished: nothing is written" + older_images());
        if (asked_at) end("interrupted again: ended at once");
        asked_at = written_at = Clock::now();
        rendering->interrupt();
        tell("interrupted: what is done is written\n");
    }
}

bool is_ignored(int signal) {
    struct sigaction now {};
    return ::sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

}  // namespace

InterruptWatch::InterruptWatch(std::vector<std::string> names, Watch& watch_of_rendering,
                               std::function<std::string()> write) {
    set_outputs(std::move(names));
    write_so_far = std::move(write);
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

namespace {

void enter(State from, State to) {
    if (state.compare_exchange_strong(from, to) || from != State::kEnding) return;
    for (;;) ::pause();  // the watcher ends the program
}

}  // namespace

void InterruptWatch::image_begins() { enter(State::kNothingDone, State::kImageBegun); }

void InterruptWatch::writing_begins() { enter(State::kImageBegun, State::kWriting); }

void InterruptWatch::written() { enter(State::kWriting, State::kWritten); }

}  // namespace lampyris

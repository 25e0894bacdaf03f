#include "commands/console.h"

#include "core/base/error.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <string>

namespace lampyris {
namespace {

constexpr int kPatienceMs = 100;

std::mutex mutex;
bool line_is_open = false;  // the terminal's last line will be replaced

// Bytes that a pipe takes without waiting once poll() says that it takes any.
constexpr size_t kAtOnce = 4096;

void write_all(std::string_view text, bool waits) {
    while (!text.empty()) {
        pollfd ready{STDERR_FILENO, POLLOUT, 0};
        if (!waits && ::poll(&ready, 1, kPatienceMs) <= 0) return;
        const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size() < kAtOnce ? text.size() : kAtOnce);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return;
        text.remove_prefix(size_t(written));
    }
}

void say(std::string_view text, bool waits, bool in_place) {
    const std::lock_guard lock(mutex);
    std::string all;
    if (in_place)
        all = "\r\033[K";
    else if (line_is_open)
        all = "\n";
    line_is_open = in_place && !text.empty() && text.back() != '\n';
    all += escaped(text);
    write_all(all, waits);
}

}  // namespace

void prepare_console() {
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);  // a file that becomes too large is an error like a full disk
    // Opened in the wrong mode, so that writes there fail instead of seeming to succeed.
    for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(fd, F_GETFD) < 0 && errno == EBADF) ::open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

void tell_text(std::string_view text) { say(text, false, false); }
void tell_last(std::string_view text) { say(text, true, false); }
void tell_in_place(std::string_view text) { say(text, false, true); }

void print_escaped(std::string_view text) { print_text(escaped(text)); }

void print_text(std::string_view text) { std::fwrite(text.data(), 1, text.size(), stdout); }

}  // namespace lampyris

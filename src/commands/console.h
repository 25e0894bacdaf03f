// What commands say on standard error and standard output. Neither may be there: closed, full, a terminal that went away, a pipe
// that nobody reads. Saying something then fails silently: no message decides whether an image is written. Whether standard output
// took what was meant for it is asked once, at the program's end.
#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace lampyris {

// Before anything is opened: a file must not become standard error because that was closed. A broken pipe becomes an error of the
// call that writes.
void prepare_console();

// On standard error. Dropped where it would have to wait for a reader.
void tell_text(std::string_view text);
// The same, but it waits: the program has nothing else to do.
void tell_last(std::string_view text);
// A line that the next one replaces, on a terminal.
void tell_in_place(std::string_view text);

template <typename... Values>
void tell(fmt::format_string<Values...> format, Values&&... values) {
    tell_text(fmt::format(format, std::forward<Values>(values)...));
}

// On standard output.
void print_text(std::string_view text);

template <typename... Values>
void print(fmt::format_string<Values...> format, Values&&... values) {
    print_text(fmt::format(format, std::forward<Values>(values)...));
}

}  // namespace lampyris

// Output of commands on standard error and standard output. Either may be unusable: closed, full, a terminal that is gone, a
// pipe that nobody reads. A message then fails silently, because no message decides whether an image is written. Errors of
// standard output are checked once, at the program's end. But for print_text, which is for JSON, names of strangers appear escaped
// (core/base/error.h), so that a terminal does not obey them.
#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace lampyris {

// To be called before anything is opened: if standard error is closed, a file must not get its descriptor. A broken pipe
// becomes an error of the call that writes.
void prepare_console();

// On standard error. Dropped if it would have to wait for a reader.
void tell_text(std::string_view text);
// The same, but it waits, because the program has nothing else to do.
void tell_last(std::string_view text);
// A line that the next one replaces, on a terminal.
void tell_in_place(std::string_view text);

template <typename... Values>
void tell(fmt::format_string<Values...> format, Values&&... values) {
    tell_text(fmt::format(format, std::forward<Values>(values)...));
}

// On standard output.
void print_text(std::string_view text);
void print_escaped(std::string_view text);

template <typename... Values>
void print(fmt::format_string<Values...> format, Values&&... values) {
    print_escaped(fmt::format(format, std::forward<Values>(values)...));
}

}  // namespace lampyris

// Errors that people read: what went wrong, where (file:line:column), and what would have been right.
//
// Assertions are for bugs; exceptions for bad input (caught once, in main); values where failing is normal.
// Nothing in the library ends the process.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

// What the process returns; a contract with scripts.
enum class ExitCode : int { kDone = 0, kBadInput = 1, kMachineCannot = 2, kInterrupted = 130 };

class Error : public std::runtime_error {
 public:
    Error(ExitCode code, const std::string& message);
    ExitCode code() const { return code_; }

 private:
    ExitCode code_;
};

// The scene or the arguments are wrong (exit code 1). The message is complete: it may hold several located errors.
class InputError : public Error {
 public:
    explicit InputError(const std::string& message) : Error(ExitCode::kBadInput, message) {}
};

// The machine cannot: no device, no memory, disk full, device lost (exit code 2).
class MachineError : public Error {
 public:
    explicit MachineError(const std::string& message) : Error(ExitCode::kMachineCannot, message) {}
};

// A location in a source text: a file known to Sources, and a byte offset. Line and column are computed on demand.
struct Location {
    static constexpr uint32_t kNoFile = 0xffffffffu;
    uint32_t file = kNoFile;
    uint64_t offset = 0;
    bool known() const { return file != kNoFile; }
};

// The texts that were read, kept so that a Location can be shown as line, column and excerpt. Texts are kept as views. If an
// owner (a mapped file) is passed, it is kept alive; otherwise it must outlive Sources. Not thread-safe: lookups extend a table
// of lines.
class Sources {
 public:
    uint32_t add(std::string name, std::string_view text, std::shared_ptr<const void> owner = nullptr);
    uint32_t add_owned(std::string name, std::string text);
    std::string_view text(uint32_t file) const;
    struct Place {
        std::string file;
        uint64_t line = 0;    // from 1
        uint64_t column = 0;  // from 1, in bytes
    };
    Place place(Location location) const;
    std::string describe(Location location) const;  // "file:line:column"
    std::string excerpt(
        Location location) const;  // the line, a newline, and a caret below the place; long lines are cut

 private:
    // Where a block of the text starts in terms of lines, so that a lookup only has to scan one block.
    static constexpr uint64_t kBlock = 4096;
    struct BlockStart {
        uint64_t lines_before = 0;
        uint64_t line_start = 0;
    };
    struct Source {
        std::string name;
        std::string owned;
        std::string_view text;
        std::shared_ptr<const void> owner;
        mutable std::vector<BlockStart> blocks;  // computed as far as needed
    };
    // The line that contains an offset: the number of lines before it, and where it begins.
    static BlockStart line_of(const Source& source, uint64_t offset);
    std::deque<Source> sources_;
};

// The nearest of `candidates` to `word` by edit distance, as " (did you mean \"x\"?)"; empty if none is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);
// "a, b, c" in the order given; a long list is cut, and the number of further names is given.
std::string list_of(const std::vector<std::string>& candidates);
// Input in a form that is safe to show in a message: cut when long, on one line, with escapes for control characters.
std::string shown(std::string_view text);
// The text without anything that a terminal would obey, or that would change the order of what is read: control characters other than
// line ends and tabulators, marks of writing direction, and bytes that are not UTF-8, become escapes such as \x1b.
std::string escaped(std::string_view text);

// Collects the errors and warnings of one scene, so that they are reported together, in the order in which a reader of the
// scene meets their causes: by file (in the order of reading) and location, no matter in which order they were found.
class Diagnostics {
 public:
    explicit Diagnostics(const Sources& sources) : sources_(&sources) {}
    // `hint` says what would have been right ("did you mean ...", "valid types are ..."). It is appended to the message after a
    // semicolon, unless it starts with a space.
    void error(Location location, std::string message, std::string hint = {});
    void warning(Location location, std::string message, std::string hint = {});
    // Reports a known part of the format that Lampyris does not simulate: as an error, or, with skip_unsupported, as a warning
    // that is kept for the statistics.
    void unsupported(Location location, std::string what, std::string hint = {});
    const Sources& sources() const { return *sources_; }
    void set_skip_unsupported(bool skip) { skip_unsupported_ = skip; }
    // Most bytes of memory for the process while a scene is read (check_process_memory); 0: no limit.
    void set_max_memory(uint64_t bytes) { max_memory_ = bytes; }
    uint64_t max_memory() const { return max_memory_; }

    bool has_errors() const { return error_count_ > 0; }
    // Throws InputError with every error so far (at most kMaxShown in full, then a count).
    void throw_if_errors() const;
    std::vector<std::string> warnings()
        const;  // formatted, with location; at most kMaxWarnings, and a line if there were more
    const std::vector<std::string>& unsupported_list() const { return skipped_; }  // "what (file:line)"
    bool full() const { return error_count_ > kMaxKept; }  // no further error's text will be shown
    // did_you_mean for names that a scene defines, of which there may be very many; `names` makes the list. Empty if nobody
    // will read the hint, or if so many names have been compared already that more would take seconds.
    template <typename Names>
    std::string guess(std::string_view word, const Names& names) {
        if (full() || names_compared_ >= kMostNamesCompared) return {};
        const std::vector<std::string> candidates = names();
        names_compared_ += candidates.size();
        return did_you_mean(word, candidates);
    }
    size_t error_count() const { return error_count_; }
    std::vector<std::string> errors() const;  // formatted, the first kMaxShown
    static constexpr size_t kMaxShown = 20;
    static constexpr size_t kMaxKept = 100;  // errors found later are only counted, wherever they are
    static constexpr size_t kMaxWarnings = 200;

 private:
    struct Record {
        Location location;
        std::string message, hint;
    };
    std::vector<std::string> formatted(const std::vector<Record>& records, const char* severity, size_t most) const;
    std::string format(const char* severity, const Record& record) const;
    const Sources* sources_;
    std::vector<Record> errors_, warnings_;
    std::vector<std::string> skipped_;
    size_t error_count_ = 0, warning_count_ = 0;
    static constexpr size_t kMostNamesCompared = 1000000;
    size_t names_compared_ = 0;
    bool skip_unsupported_ = false;
    uint64_t max_memory_ = 0;
};

}  // namespace lampyris

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
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
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

// A place in a source text: a file known to Sources, and a byte offset in it. Line and column are computed when asked for.
struct Location {
    static constexpr uint32_t kNoFile = 0xffffffffu;
    uint32_t file = kNoFile;
    uint64_t offset = 0;
    bool known() const { return file != kNoFile; }
};

// The texts that were read, kept so that a Location can be shown as line, column and excerpt.
// Text is kept by view, with a share of its owner (a mapped file) where one is handed over; otherwise the owner must
// outlive Sources. Not for several threads at once: places are found by a table that grows as they are asked for.
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
    // What is known of the line in which a block of the text begins: so a place is found by looking at one block.
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
        mutable std::vector<BlockStart> blocks;  // as far as was asked for
    };
    // The line of an offset: how many come before it, and where it begins.
    static BlockStart line_of(const Source& source, uint64_t offset);
    std::deque<Source> sources_;
};

// The nearest of `candidates` to `word` by edit distance, as " (did you mean \"x\"?)", or empty where none is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);
// "a, b, c" in the order given; of very many, the first ones and how many more there are.
std::string list_of(const std::vector<std::string>& candidates);
// A piece of input fit to stand in a message: cut when long, without control characters.
std::string shown(std::string_view text);

// Collects the errors and warnings of one scene, so that they are reported together, in the order in which a reader of the
// scene meets their causes: by file (in the order of reading) and place in it, whoever found them first.
class Diagnostics {
 public:
    explicit Diagnostics(const Sources& sources) : sources_(&sources) {}
    // `hint` says what would have been right ("did you mean ...", "valid types are ..."); it ends the message, after a
    // semicolon unless it starts with a space.
    void error(Location location, std::string message, std::string hint = {});
    void warning(Location location, std::string message, std::string hint = {});
    // A known part of the format that Lampyris does not simulate: an error, or, with skip_unsupported, a warning that is
    // remembered for the statistics.
    void unsupported(Location location, std::string what, std::string hint = {});
    const Sources& sources() const { return *sources_; }
    void set_skip_unsupported(bool skip) { skip_unsupported_ = skip; }

    bool has_errors() const { return error_count_ > 0; }
    // Throws InputError with every error so far (at most kMaxShown in full, then a count).
    void throw_if_errors() const;
    std::vector<std::string> warnings()
        const;  // formatted, with location; at most kMaxWarnings, and a line if there were more
    const std::vector<std::string>& unsupported_list() const { return skipped_; }  // "what (file:line)"
    bool full() const { return error_count_ > kMaxKept; }  // nobody will read a further error's text
    // did_you_mean for names that a scene defines, of which there may be very many: `names` makes the list. Empty where no
    // one will read it, or where so many names have been compared already that more would take seconds.
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
    static constexpr size_t kMaxKept = 100;  // errors found later are counted only, wherever they stand
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
};

}  // namespace lampyris

// A scene text as tokens: words, quoted strings and brackets, each with its place; comments and blanks are skipped.
#pragma once

#include "core/base/error.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace lampyris {

class FileText;

enum class TokenKind { kEnd, kWord, kString, kOpen, kClose };

struct Token {
    TokenKind kind = TokenKind::kEnd;
    bool escaped = false;   // a string with backslashes: see Tokenizer::string_value
    std::string_view text;  // a string's without its quotes
    Location location;      // of its first character, a string's quote included
};

class Tokenizer {
 public:
    // `file` is the text's number in the Sources that `diagnostics` knows. `mapping`, if given, is the mapped file that
    // contains the text: its pages are released once they have been read.
    Tokenizer(std::string_view text, uint32_t file, Diagnostics& diagnostics, const FileText* mapping = nullptr);

    Token next();  // at the end kEnd, and on every later call
    const Token& peek();
    std::string string_value(const Token& token);  // with its escapes (\n, \t, \", ...) resolved

    // For loops over long arrays of numbers: the text from the first character of the next token on, as [cursor(), end()), and
    // the position from which to continue.
    const char* cursor();
    const char* end() const { return end_; }
    void set_cursor(const char* cursor);
    static const char* skip_blank(const char* p, const char* end);

    Location location(const char* p) const { return {file_, static_cast<uint64_t>(p - begin_)}; }
    uint32_t file() const { return file_; }
    void release_consumed();

 private:
    Token scan();
    const char *begin_, *cursor_, *end_;
    uint32_t file_;
    Diagnostics* diagnostics_;
    const FileText* mapping_;
    const char* released_;
    Token peeked_;
    bool has_peeked_ = false;
};

}  // namespace lampyris

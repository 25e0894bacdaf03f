#include "core/scene/tokenizer.h"

#include "core/scene/file_text.h"

#include <cstring>

namespace lampyris {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }
bool ends_word(char c) { return is_blank(c) || c == '"' || c == '[' || c == ']' || c == '#'; }

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

}  // namespace

Tokenizer::Tokenizer(std::string_view text, uint32_t file, Diagnostics& diagnostics, const FileText* mapping)
    : begin_(text.data()),
      cursor_(text.data()),
      end_(text.data() + text.size()),
      file_(file),
      diagnostics_(&diagnostics),
      mapping_(mapping),
      released_(text.data()) {
    if (text.starts_with(kByteOrderMark)) cursor_ += kByteOrderMark.size();
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
        diagnostics.error(location(begin_), "this text is in UTF-16", "save it as UTF-8 or ASCII");
        cursor_ = end_;
    }
}

const char* Tokenizer::skip_blank(const char* p, const char* end) {
    while (p != end) {
        if (is_blank(*p)) {
            ++p;
        } else if (*p == '#') {
            while (p != end && *p != '\n' && *p != '\r') ++p;
        } else {
            break;
        }
    }
    return p;
}

Token Tokenizer::next() {
    if (!has_peeked_) return scan();
    has_peeked_ = false;
    return peeked_;
}

const Token& Tokenizer::peek() {
    if (!has_peeked_) {
        peeked_ = scan();
        has_peeked_ = true;
    }
    return peeked_;
}

const char* Tokenizer::cursor() {
    if (has_peeked_) {
        has_peeked_ = false;
        cursor_ = begin_ + peeked_.location.offset;
    }
    cursor_ = skip_blank(cursor_, end_);
    return cursor_;
}

void Tokenizer::set_cursor(const char* cursor) {
    has_peeked_ = false;
    cursor_ = cursor;
}

Token Tokenizer::scan() {
    cursor_ = skip_blank(cursor_, end_);
    Token token;
    token.location = location(cursor_);
    if (cursor_ == end_) return token;
    const char* start = cursor_;
    if (*start == '[' || *start == ']') {
        token.kind = *start == '[' ? TokenKind::kOpen : TokenKind::kClose;
        ++cursor_;
        token.text = {start, 1};
    } else if (*start == '"') {
        token.kind = TokenKind::kString;
        const char* p = start + 1;
        for (; p != end_ && *p != '"' && *p != '\n'; ++p) {
            if (*p == '\\' && p + 1 != end_ && p[1] != '\n') {
                token.escaped = true;
                ++p;
            }
        }
        token.text = {start + 1, static_cast<size_t>(p - start - 1)};
        if (p == end_ || *p == '\n')
            diagnostics_->error(token.location, "this string is not closed on its line", "close it with '\"'");
        else
            ++p;
        cursor_ = p;
    } else {
        token.kind = TokenKind::kWord;
        while (cursor_ != end_ && !ends_word(*cursor_)) ++cursor_;
        token.text = {start, static_cast<size_t>(cursor_ - start)};
    }
    return token;
}

std::string Tokenizer::string_value(const Token& token) {
    if (!token.escaped) return std::string(token.text);
    static constexpr std::string_view kCodes = "nrtbf\\\"'";
    static constexpr std::string_view kMeanings = "\n\r\t\b\f\\\"'";
    std::string value;
    for (size_t i = 0; i < token.text.size(); ++i) {
        if (token.text[i] != '\\' || i + 1 == token.text.size()) {
            value += token.text[i];
            continue;
        }
        const char code = token.text[++i];
        const size_t known = kCodes.find(code);
        if (known != std::string_view::npos)
            value += kMeanings[known];
        else
            diagnostics_->error({token.location.file, token.location.offset + i},
                                std::string("unknown escape sequence \"\\") + shown({&code, 1}) + "\" in a string",
                                "known are \\n \\r \\t \\b \\f \\\\ \\\" \\'; a backslash itself is \\\\");
    }
    return value;
}

void Tokenizer::release_consumed() {
    constexpr ptrdiff_t kStep = 16 << 20;
    if (!mapping_ || cursor_ - released_ < kStep) return;
    released_ = cursor_;
    mapping_->release_before(static_cast<size_t>(cursor_ - begin_));
}

}  // namespace lampyris

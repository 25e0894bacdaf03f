#include "core/base/error.h"

#include <algorithm>
#include <cctype>
#include <numeric>

namespace lampyris {
namespace {

constexpr size_t kMaxExcerpt = 100;  // bytes of a source line that an excerpt shows

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xc0u) == 0x80u; }

char printable(char c) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\t') return ' ';
    return byte < 0x20 || byte == 0x7f ? '?' : c;
}

// A byte as an escape: \x00.
std::string escape_of(char c) {
    constexpr const char* kDigits = "0123456789abcdef";
    const auto value = static_cast<unsigned char>(c);
    return {'\\', 'x', kDigits[value >> 4], kDigits[value & 15]};
}

// what() ends at a zero byte.
std::string without_zeros(const std::string& message) {
    std::string text;
    for (const char c : message)
        if (c == '\0')
            text += escape_of(c);
        else
            text += c;
    return text;
}

// Names in a scene may be as long as their file.
std::string at_most(std::string text, size_t bytes) {
    if (text.size() <= bytes) return text;
    while (bytes > 0 && is_continuation(text[bytes])) --bytes;
    return text.substr(0, bytes) + "...";
}

}  // namespace

Error::Error(ExitCode code, const std::string& message) : std::runtime_error(without_zeros(message)), code_(code) {}

uint32_t Sources::add(std::string name, std::string_view text, std::shared_ptr<const void> owner) {
    sources_.push_back({std::move(name), {}, text, std::move(owner), {}});
    return static_cast<uint32_t>(sources_.size() - 1);
}

uint32_t Sources::add_owned(std::string name, std::string text) {
    sources_.push_back({std::move(name), std::move(text), {}, {}, {}});
    sources_.back().text = sources_.back().owned;
    return static_cast<uint32_t>(sources_.size() - 1);
}

std::string_view Sources::text(uint32_t file) const { return file < sources_.size() ? sources_[file].text : ""; }

Sources::BlockStart Sources::line_of(const Source& source, uint64_t offset) {
    const auto pass = [&](BlockStart line, uint64_t from, uint64_t to) {
        const std::string_view part = source.text.substr(from, to - from);
        line.lines_before += static_cast<uint64_t>(std::count(part.begin(), part.end(), '\n'));
        const size_t newline = part.rfind('\n');
        if (newline != std::string_view::npos) line.line_start = from + newline + 1;
        return line;
    };
    std::vector<BlockStart>& blocks = source.blocks;
    if (blocks.empty()) blocks.emplace_back();
    while (blocks.size() <= offset / kBlock)
        blocks.push_back(pass(blocks.back(), (blocks.size() - 1) * kBlock, blocks.size() * kBlock));
    return pass(blocks[offset / kBlock], offset / kBlock * kBlock, offset);
}

Sources::Place Sources::place(Location location) const {
    if (location.file >= sources_.size()) return {};
    const Source& source = sources_[location.file];
    const uint64_t offset = std::min<uint64_t>(location.offset, source.text.size());
    const BlockStart line = line_of(source, offset);
    return {source.name, line.lines_before + 1, offset - line.line_start + 1};
}

std::string Sources::describe(Location location) const {
    const Place p = place(location);
    if (p.line == 0) return {};
    return p.file + ":" + std::to_string(p.line) + ":" + std::to_string(p.column);
}

std::string Sources::excerpt(Location location) const {
    if (location.file >= sources_.size()) return {};
    const Source& source = sources_[location.file];
    const size_t offset = std::min<uint64_t>(location.offset, source.text.size());
    size_t start = line_of(source, offset).line_start;
    // Searched no further than is shown, because a line may be as long as its file.
    const std::string_view text =
        source.text.substr(0, offset + std::min(source.text.size() - offset, 2 * kMaxExcerpt));
    size_t stop = std::min(text.find_first_of("\r\n", offset), text.size());
    // A window of a long line that contains the location, cut between characters.
    std::string prefix, suffix;
    if (stop - start > kMaxExcerpt && offset - start > kMaxExcerpt * 3 / 4) {
        start = offset - kMaxExcerpt / 2;
        while (start < offset && is_continuation(text[start])) ++start;
        prefix = "...";
    }
    if (stop - start > kMaxExcerpt) {
        stop = start + kMaxExcerpt;
        while (stop > offset && is_continuation(text[stop])) --stop;
        suffix = "...";
    }
    std::string line = prefix;
    std::string caret(prefix.size(), ' ');
    for (size_t i = start; i < stop; ++i) {
        line += printable(text[i]);
        if (i < offset && !is_continuation(text[i])) caret += ' ';
    }
    return line + suffix + "\n" + caret + "^";
}

void Diagnostics::error(Location location, std::string message, std::string hint) {
    if (++error_count_ <= kMaxKept) errors_.push_back({location, std::move(message), std::move(hint)});
}

void Diagnostics::warning(Location location, std::string message, std::string hint) {
    if (++warning_count_ <= kMaxWarnings) warnings_.push_back({location, std::move(message), std::move(hint)});
}

// NOLINTBEGIN(performance-unnecessary-value-param): the texts are made for the call; none is copied.
void Diagnostics::unsupported(Location location, std::string what, std::string hint) {
    if (!skip_unsupported_) {
        error(location, what + " is not supported",
              hint.empty() ? "--skip-unsupported renders the scene without it" : hint);
        return;
    }
    warning(location, what + " is not supported and is left out", hint);
    if (skipped_.size() >= kMaxWarnings) return;
    const Sources::Place place = sources_->place(location);
    skipped_.push_back(place.line == 0 ? what : what + " (" + place.file + ":" + std::to_string(place.line) + ")");
}

// NOLINTEND(performance-unnecessary-value-param)

std::vector<std::string> Diagnostics::errors() const { return formatted(errors_, "error", kMaxShown); }

std::vector<std::string> Diagnostics::warnings() const {
    std::vector<std::string> texts = formatted(warnings_, "warning", kMaxWarnings);
    if (warning_count_ > kMaxWarnings) texts.emplace_back("warning: further warnings are not shown");
    return texts;
}

void Diagnostics::throw_if_errors() const {
    if (error_count_ == 0) return;
    std::string message;
    const std::vector<std::string> texts = errors();
    for (const std::string& text : texts) message += (message.empty() ? "" : "\n") + text;
    if (error_count_ > texts.size()) message += "\nerror: and " + std::to_string(error_count_ - texts.size()) + " more";
    throw InputError(message);
}

std::vector<std::string> Diagnostics::formatted(const std::vector<Record>& records, const char* severity,
                                                size_t most) const {
    std::vector<const Record*> order;
    order.reserve(records.size());
    for (const Record& record : records) order.push_back(&record);
    // A stable sort: errors at the same location stay in the order in which they were found. Errors without a location come
    // last.
    std::ranges::stable_sort(order, [](const Record* a, const Record* b) {
        return a->location.file != b->location.file ? a->location.file < b->location.file
                                                    : a->location.offset < b->location.offset;
    });
    std::vector<std::string> texts;
    for (size_t i = 0; i < std::min(order.size(), most); ++i) texts.push_back(format(severity, *order[i]));
    return texts;
}

std::string Diagnostics::format(const char* severity, const Record& record) const {
    std::string text = sources_->describe(record.location);
    if (!text.empty()) text += ": ";
    text += severity;
    constexpr size_t kMaxMessage = 4000;
    text += ": " + at_most(record.message, kMaxMessage);
    if (!record.hint.empty())
        text += at_most(record.hint.front() == ' ' ? record.hint : "; " + record.hint, kMaxMessage);
    const std::string excerpt = sources_->excerpt(record.location);
    if (!excerpt.empty()) text += "\n" + excerpt;
    return text;
}

namespace {

// Levenshtein's distance with neighbouring letters swapped counting as one (optimal string alignment); case counts half.
size_t distance_in_halves(std::string_view a, std::string_view b) {
    std::vector<size_t> before, previous(b.size() + 1), current(b.size() + 1);
    for (size_t j = 0; j <= b.size(); ++j) previous[j] = 2 * j;
    for (size_t i = 1; i <= a.size(); ++i) {
        current[0] = 2 * i;
        for (size_t j = 1; j <= b.size(); ++j) {
            const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
            const size_t change = a[i - 1] == b[j - 1] ? 0 : lower(a[i - 1]) == lower(b[j - 1]) ? 1 : 2;
            current[j] = std::min({previous[j] + 2, current[j - 1] + 2, previous[j - 1] + change});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                current[j] = std::min(current[j], before[j - 2] + 2);
        }
        before = std::move(previous);
        previous = current;
    }
    return previous[b.size()];
}

}  // namespace

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
    constexpr size_t kMaxWord = 64;
    if (word.empty() || word.size() > kMaxWord) return {};
    const std::string* best = nullptr;
    // At most a third of the letters may differ, so that only guesses are made that a reader would make, too.
    size_t best_distance = 2 * std::max<size_t>(1, word.size() / 3) + 1;
    for (const std::string& candidate : candidates) {
        if (candidate.empty() || candidate.size() > kMaxWord || candidate == word) continue;
        const size_t longer = std::max(word.size(), candidate.size()),
                     shorter = std::min(word.size(), candidate.size());
        if (2 * (longer - shorter) >= best_distance) continue;
        const size_t distance = distance_in_halves(word, candidate);
        if (distance < best_distance) {
            best_distance = distance;
            best = &candidate;
        }
    }
    return best && best_distance < 2 * word.size() ? " (did you mean \"" + *best + "\"?)" : std::string();
}

std::string list_of(const std::vector<std::string>& candidates) {
    constexpr size_t kMostListed = 100;  // only a scene's own names may be more
    std::string text;
    for (size_t i = 0; i < std::min(candidates.size(), kMostListed); ++i)
        text += (text.empty() ? "" : ", ") + candidates[i];
    if (candidates.size() > kMostListed) text += " and " + std::to_string(candidates.size() - kMostListed) + " more";
    return text;
}

namespace {

// The length of the UTF-8 character at the beginning of a text, and its code; 0 if there is none.
size_t decode_utf8(std::string_view text, uint32_t& code) {
    const auto byte = [&](size_t i) { return uint32_t(static_cast<unsigned char>(text[i])); };
    code = byte(0);
    if (code < 0x80) return 1;
    const size_t length = code >= 0xf0 && code < 0xf5   ? 4
                          : code >= 0xe0 && code < 0xf0 ? 3
                          : code >= 0xc2 && code < 0xe0 ? 2
                                                        : 0;
    if (length == 0 || text.size() < length) return 0;
    code &= 0x7fu >> length;
    for (size_t i = 1; i < length; ++i) {
        if (!is_continuation(text[i])) return 0;
        code = code << 6 | (byte(i) & 0x3fu);
    }
    const uint32_t least = length == 2 ? 0x80 : length == 3 ? 0x800 : 0x10000;
    return code < least || (code >= 0xd800 && code < 0xe000) || code > 0x10ffff ? 0 : length;
}

bool is_harmless(uint32_t code) {
    if (code < 0x20) return code == '\n' || code == '\t';
    if (code >= 0x7f && code < 0xa0) return false;
    const bool directs = code == 0x61c || code == 0x200e || code == 0x200f || (code >= 0x2028 && code <= 0x202e) ||
                         (code >= 0x2066 && code <= 0x2069);
    // Tags, and what else has no width.
    const bool is_invisible = code == 0xad || code == 0x180e || (code >= 0x200b && code <= 0x200d) ||
                              (code >= 0x2060 && code <= 0x2064) || code == 0xfeff ||
                              (code >= 0xfff9 && code <= 0xfffb) || (code >= 0xe0000 && code <= 0xe0fff);
    return !directs && !is_invisible;
}

}  // namespace

std::string escaped(std::string_view text) {
    std::string result;
    while (!text.empty()) {
        uint32_t code = 0;
        const size_t length = decode_utf8(text, code);
        const std::string_view bytes = text.substr(0, std::max<size_t>(length, 1));
        if (length > 0 && is_harmless(code)) {
            result += bytes;
        } else {
            for (const char c : bytes) result += escape_of(c);
        }
        text.remove_prefix(bytes.size());
    }
    return result;
}

std::string shown(std::string_view text) {
    constexpr size_t kMaxShownText = 60;
    std::string result;
    size_t stop = std::min(text.size(), kMaxShownText);
    while (stop < text.size() && stop > 0 && is_continuation(text[stop])) --stop;
    for (const char c : text.substr(0, stop))
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            result += escape_of(c);
        else
            result += c;
    return stop < text.size() ? result + "..." : result;
}

}  // namespace lampyris

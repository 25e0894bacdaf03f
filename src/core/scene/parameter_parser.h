// Reads parameter lists: `"type name" value` or `"type name" [ values ]`, as many as follow.
#pragma once

#include "core/scene/description.h"
#include "core/scene/pbrt_v3.h"
#include "core/scene/tokenizer.h"

namespace lampyris {

class ParameterParser {
 public:
    ParameterParser(Diagnostics& diagnostics, OldFormat& old_format)
        : diagnostics_(&diagnostics), old_format_(&old_format) {}
    // Adds parameters up to the first token that starts none. Errors are reported, and parsing continues after them.
    void parse(Tokenizer& tokenizer, std::string_view color_space, ParameterList& list);

 private:
    bool parse_declaration(Tokenizer& tokenizer, const Token& token, Parameter& parameter);
    bool parse_values(Tokenizer& tokenizer, Parameter& parameter);
    template <typename T>
    bool parse_numbers(Tokenizer& tokenizer, const Parameter& parameter, std::vector<T>& values);
    bool parse_words(Tokenizer& tokenizer, Parameter& parameter);
    bool parse_word(Tokenizer& tokenizer, const Token& token, Parameter& parameter);
    bool check_count(const Parameter& parameter);
    bool missing_value(const Parameter& parameter, const Token& found);
    bool ends_unclosed(Tokenizer& tokenizer, const Parameter& parameter, Location open);
    void skip_values(Tokenizer& tokenizer);
    void wrong_value(const Parameter& parameter, const Token& token, const char* expected);

    Diagnostics* diagnostics_;
    OldFormat* old_format_;
    // Arrays are read into these buffers and copied if small, so that small arrays have no unused capacity and large ones are
    // not copied.
    std::vector<float> floats_;
    std::vector<int32_t> ints_;
};

// A word that starts a directive ("Shape"); parsing continues there after an error. Defined with the directives' table.
bool is_directive(std::string_view word);

}  // namespace lampyris

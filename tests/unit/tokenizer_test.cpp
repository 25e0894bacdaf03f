// Tokens of a scene text, its numbers, and how errors are shown.
#include "core/scene/tokenizer.h"

#include "core/scene/number.h"

#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <random>

using namespace lampyris;

namespace {

struct Text {
    Sources sources;
    Diagnostics diagnostics{sources};
    uint32_t file;
    Tokenizer tokenizer;
    explicit Text(std::string_view text) : file(sources.add("a.pbrt", text)), tokenizer(text, file, diagnostics) {}
};

NumberStatus status_of_float(std::string_view text, float& value) {
    const NumberResult result = parse_float(text.data(), text.data() + text.size(), value);
    EXPECT_EQ(result.end, text.data() + text.size());
    return result.status;
}

// The result of std::from_chars, which is correctly rounded.
float expected_float(std::string_view text) {
    float value = 0.0f;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

}  // namespace

TEST(Tokenizer, SplitsWordsStringsAndBrackets) {
    Text text("Shape \"sphere\"[1-2]\t# a comment \"[\r\nend#x");
    const std::pair<TokenKind, std::string_view> expected[] = {
        {TokenKind::kWord, "Shape"}, {TokenKind::kString, "sphere"}, {TokenKind::kOpen, "["}, {TokenKind::kWord, "1-2"},
        {TokenKind::kClose, "]"},    {TokenKind::kWord, "end"},      {TokenKind::kEnd, ""},   {TokenKind::kEnd, ""}};
    for (const auto& [kind, content] : expected) {
        EXPECT_EQ(text.tokenizer.peek().kind, kind);
        const Token token = text.tokenizer.next();
        EXPECT_EQ(token.kind, kind);
        EXPECT_EQ(token.text, content);
    }
    EXPECT_FALSE(text.diagnostics.has_errors());
}

TEST(Tokenizer, PlacesTokens) {
    Text text(
        "\xef\xbb\xbf"
        "a\n  \"b\"\r\n\tc");  // with a byte order mark
    EXPECT_EQ(text.sources.describe(text.tokenizer.next().location), "a.pbrt:1:4");
    EXPECT_EQ(text.sources.describe(text.tokenizer.next().location), "a.pbrt:2:3");
    EXPECT_EQ(text.sources.describe(text.tokenizer.next().location), "a.pbrt:3:2");
    EXPECT_EQ(text.sources.describe(Location{}), "");
    EXPECT_EQ(text.sources.describe(Location{7, 0}), "");
}

TEST(Tokenizer, ResolvesEscapes) {
    Text text(R"("a\"b\\c\n\t" "\q")");
    EXPECT_EQ(text.tokenizer.string_value(text.tokenizer.next()), "a\"b\\c\n\t");
    EXPECT_FALSE(text.diagnostics.has_errors());
    text.tokenizer.string_value(text.tokenizer.next());
    ASSERT_EQ(text.diagnostics.errors().size(), 1u);
    EXPECT_NE(text.diagnostics.errors()[0].find("a.pbrt:1:16: error: unknown escape sequence \"\\q\""),
              std::string::npos)
        << text.diagnostics.errors()[0];
}

TEST(Tokenizer, ReportsStringsThatDoNotEnd) {
    for (const char* bad : {"\"abc\nd", "\"abc", "\"abc\\\"", "\"abc\\"}) {
        Text text(bad);
        text.tokenizer.next();
        EXPECT_EQ(text.diagnostics.error_count(), 1u) << bad;
    }
}

TEST(Tokenizer, ReportsUtf16) {
    Text text(std::string_view("\xff\xfeS\0h\0", 6));
    EXPECT_EQ(text.tokenizer.next().kind, TokenKind::kEnd);
    EXPECT_EQ(text.diagnostics.error_count(), 1u);
}

TEST(Numbers, AreExact) {
    // Halfway cases between two floats, the smallest and largest floats, and numbers with more digits than 64 bits hold.
    for (const char* text : {"0",
                             "-0",
                             "1",
                             "-1.5",
                             ".5",
                             "5.",
                             "1e3",
                             "1E-3",
                             "0.1",
                             "16777217",
                             "16777219",
                             "16777217.0000001",
                             "3.4028235e38",
                             "3.40282356e38",
                             "1.17549435e-38",
                             "1.1754942e-38",
                             "1.4e-45",
                             "7.1e-46",
                             "0.00000000000000000000000000001234567",
                             "123456789012345678901234567890",
                             "1.00000005960464477539062500000000000001",
                             "1.000000059604644775390625",
                             "0.3333333333333333333333333333333333",
                             "8.5899345920000001e9",
                             "1e22",
                             "1e-22",
                             "9007199254740993"}) {
        float value = -7.0f;
        EXPECT_EQ(status_of_float(text, value), NumberStatus::kOk) << text;
        EXPECT_EQ(std::bit_cast<uint32_t>(value), std::bit_cast<uint32_t>(expected_float(text))) << text;
    }
    float value = 0.0f;
    EXPECT_EQ(status_of_float("+2.5", value), NumberStatus::kOk);
    EXPECT_EQ(value, 2.5f);
    for (const char* tiny : {"1e-60", "-1e-400", "0.0e999", "1e-99999999999999999999", "0e99999999999999"}) {
        EXPECT_EQ(status_of_float(tiny, value), NumberStatus::kOk) << tiny;
        EXPECT_EQ(value, 0.0f) << tiny;
    }
    for (const char* huge : {"1e39", "-1e400", "1e99999999999999999999", "3.5e38"})
        EXPECT_EQ(status_of_float(huge, value), NumberStatus::kOutOfRange) << huge;
    for (const char* bad :
         {"", "-", "+", ".", "e5", "1e", "1e+", "1.2.3", "0x10", "inf", "nan", "-inf", "1,", "--1", "+-1", "1f"})
        EXPECT_EQ(status_of_float(bad, value), NumberStatus::kNotANumber) << bad;
}

// Random floats and decimal texts near the midpoints of floats: 2 million comparisons with std::from_chars.
TEST(Numbers, AgreeWithTheStandardLibrary) {
    std::mt19937_64 random(1);
    char buffer[64];
    for (int i = 0; i < 1000000; ++i) {
        const auto bits = static_cast<uint32_t>(random());
        const float value = std::bit_cast<float>(bits);
        if (!std::isfinite(value)) continue;
        // The midpoint between this float and the next, cut to 6 to 18 digits: next to where two roundings go wrong.
        const double middle = 0.5 * (double(value) + double(std::nextafter(value, 2.0f * value)));
        for (double shown : {double(value), middle}) {
            const int precision = 6 + static_cast<int>(random() % 12);
            const auto written =
                std::to_chars(buffer, buffer + sizeof buffer, shown, std::chars_format::scientific, precision);
            const std::string_view text(buffer, static_cast<size_t>(written.ptr - buffer));
            float expected = 0.0f;
            const auto read = std::from_chars(text.data(), text.data() + text.size(), expected);
            if (read.ec != std::errc()) continue;
            float parsed = 0.0f;
            ASSERT_EQ(parse_float(text.data(), text.data() + text.size(), parsed).status, NumberStatus::kOk) << text;
            ASSERT_EQ(std::bit_cast<uint32_t>(parsed), std::bit_cast<uint32_t>(expected)) << text;
        }
    }
}

TEST(Numbers, ReadIntegers) {
    const auto parse = [](std::string_view text, int32_t& value) {
        return parse_int(text.data(), text.data() + text.size(), value).status;
    };
    int32_t value = 0;
    for (const auto& [text, expected] : {std::pair<const char*, int32_t>{"0", 0},
                                         {"-5", -5},
                                         {"+7", 7},
                                         {"2147483647", INT32_MAX},
                                         {"-2147483648", INT32_MIN},
                                         {"0000000000000000000012", 12}}) {
        EXPECT_EQ(parse(text, value), NumberStatus::kOk) << text;
        EXPECT_EQ(value, expected);
    }
    for (const char* text : {"2147483648", "-2147483649", "99999999999999999999999", "-99999999999999999999999"})
        EXPECT_EQ(parse(text, value), NumberStatus::kOutOfRange) << text;
    for (const char* text : {"", "-", "1.0", "1e3", "x", "1x"})
        EXPECT_EQ(parse(text, value), NumberStatus::kNotANumber) << text;
}

TEST(Sources, ShowTheLineWithACaret) {
    Sources sources;
    const uint32_t file = sources.add_owned("b", "first\n\tx = \xc3\xa4\xc3\xb6 y\r\nlast");
    EXPECT_EQ(sources.excerpt({file, 0}), "first\n^");
    EXPECT_EQ(sources.excerpt({file, 16}), " x = \xc3\xa4\xc3\xb6 y\n        ^");  // below the y: counted in characters
    EXPECT_EQ(sources.excerpt({file, 1000}), "last\n    ^");
    // Long lines are cut around the location, with the caret still below it.
    const std::string line = std::string(500, 'a') + "X" + std::string(500, 'b');
    const uint32_t longer = sources.add_owned("c", line);
    const std::string excerpt = sources.excerpt({longer, 500});
    const size_t newline = excerpt.find('\n');
    EXPECT_LT(newline, 120u);
    EXPECT_EQ(excerpt[excerpt.find('^') - newline - 1], 'X');
}

TEST(DidYouMean, FindsWhatIsNear) {
    const std::vector<std::string> names{"diffuse", "dielectric", "conductor", "coateddiffuse", "mix"};
    EXPECT_EQ(did_you_mean("difuse", names), " (did you mean \"diffuse\"?)");
    EXPECT_EQ(did_you_mean("idffuse", names), " (did you mean \"diffuse\"?)");
    EXPECT_EQ(did_you_mean("Dielectric", names), " (did you mean \"dielectric\"?)");
    EXPECT_EQ(did_you_mean("mxi", names), " (did you mean \"mix\"?)");
    EXPECT_EQ(did_you_mean("velvet", names), "");
    EXPECT_EQ(did_you_mean("", names), "");
    EXPECT_EQ(did_you_mean("x", {}), "");
}

TEST(Diagnostics, ReportTogetherAndCount) {
    Sources sources;
    const uint32_t file = sources.add_owned("d", "text");
    Diagnostics diagnostics(sources);
    EXPECT_NO_THROW(diagnostics.throw_if_errors());
    for (int i = 0; i < 25; ++i) diagnostics.error({file, 2}, "wrong " + std::to_string(i), "right");
    try {
        diagnostics.throw_if_errors();
        FAIL();
    } catch (const InputError& error) {
        const std::string text = error.what();
        EXPECT_EQ(text.find("d:1:3: error: wrong 0; right\ntext\n  ^\n"), 0u) << text;
        EXPECT_NE(text.find("wrong 19"), std::string::npos);
        EXPECT_EQ(text.find("wrong 20"), std::string::npos);
        EXPECT_NE(text.find("and 5 more"), std::string::npos);
        EXPECT_EQ(error.code(), ExitCode::kBadInput);
    }
}

TEST(Diagnostics, TurnTheUnsupportedIntoWarningsWhenAsked) {
    Sources sources;
    const uint32_t file = sources.add_owned("e", "\nMaterial");
    Diagnostics strict(sources);
    strict.unsupported({file, 1}, "material \"hair\"");
    EXPECT_TRUE(strict.has_errors());
    EXPECT_TRUE(strict.unsupported_list().empty());
    Diagnostics lenient(sources);
    lenient.set_skip_unsupported(true);
    lenient.unsupported({file, 1}, "material \"hair\"");
    EXPECT_FALSE(lenient.has_errors());
    EXPECT_EQ(lenient.warnings().size(), 1u);
    EXPECT_EQ(lenient.unsupported_list(), (std::vector<std::string>{"material \"hair\" (e:2)"}));
}

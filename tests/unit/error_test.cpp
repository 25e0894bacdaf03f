// Diagnostics: how a scene's mistakes are reported, in the order in which a reader meets them.
#include "core/base/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

using namespace lampyris;

namespace {

TEST(Error, MistakesAreToldInTheOrderOfTheSource) {
    Sources sources;
    const uint32_t first = sources.add_owned("first.pbrt", "one\ntwo\nthree\n"),
                   second = sources.add_owned("second.pbrt", "four\n");
    Diagnostics diagnostics(sources);
    diagnostics.error({}, "nowhere");
    diagnostics.error({second, 0}, "at four");
    diagnostics.error({first, 8}, "at three");
    diagnostics.error({first, 0}, "at one");
    diagnostics.error({first, 8}, "at three again");
    diagnostics.error({first, 4}, "at two");
    const std::vector<std::string> errors = diagnostics.errors();
    const char* const expected[] = {"first.pbrt:1:1: error: at one",   "first.pbrt:2:1: error: at two",
                                    "first.pbrt:3:1: error: at three", "first.pbrt:3:1: error: at three again",
                                    "second.pbrt:1:1: error: at four", "error: nowhere"};
    ASSERT_EQ(errors.size(), std::size(expected));
    for (size_t i = 0; i < errors.size(); ++i) EXPECT_EQ(errors[i].substr(0, errors[i].find('\n')), expected[i]);
    try {
        diagnostics.throw_if_errors();
        FAIL() << "there are errors";
    } catch (const InputError& thrown) {
        std::string all;
        for (const std::string& error : errors) all += (all.empty() ? "" : "\n") + error;
        EXPECT_EQ(thrown.what(), all);
    }
}

// Lines and columns compared with counting from the file's start, in random order: for short lines, for lines as long as the
// blocks that lookups use, and for a file of a single line.
TEST(Error, PlacesAreThoseOfCounting) {
    std::string lines;
    for (int i = 0; lines.size() < 50000; ++i) lines += std::string(size_t(i * i % 97), 'x') + (i % 3 ? "\n" : "\r\n");
    std::string blocks;
    for (const size_t length : {4095, 4096, 4097, 0, 0, 12288, 1}) blocks += std::string(length, 'y') + "\n";
    std::mt19937 random(7);
    for (const std::string& text : {lines, blocks, std::string(30000, 'z'), std::string()}) {
        Sources sources;
        const uint32_t file = sources.add_owned("a.pbrt", text);
        std::vector<uint64_t> offsets{0, 1, 4095, 4096, 4097, 8192, text.size(), text.size() + 1};
        for (int i = 0; i < 300; ++i)
            offsets.push_back(std::uniform_int_distribution<uint64_t>(0, text.size())(random));
        for (const uint64_t offset : offsets) {
            const std::string before = text.substr(0, offset);
            const size_t newline = before.rfind('\n');
            const Sources::Place place = sources.place({file, offset});
            EXPECT_EQ(place.line, 1 + uint64_t(std::count(before.begin(), before.end(), '\n'))) << offset;
            EXPECT_EQ(place.column, before.size() - (newline == std::string::npos ? 0 : newline + 1) + 1) << offset;
        }
    }
}

// In a very long line, the excerpt is cut at the same length anyway.
TEST(Error, LongLinesAreCutAroundThePlace) {
    Sources sources;
    const uint32_t file =
        sources.add_owned("a.pbrt", "first\n" + std::string(20000, 'a') + "!" + std::string(20000, 'b'));
    EXPECT_EQ(sources.excerpt({file, 20006}),
              "..." + std::string(50, 'a') + "!" + std::string(49, 'b') + "...\n" + std::string(53, ' ') + "^");
    EXPECT_EQ(sources.excerpt({file, 6}), std::string(100, 'a') + "...\n^");
}

// If a scene defines very many names, suggestions must not take too long.
TEST(Error, GuessesAreLimited) {
    Sources sources;
    Diagnostics diagnostics(sources);
    int asked = 0;
    const auto names = [&] {
        ++asked;
        return std::vector<std::string>(300000, "glass");
    };
    EXPECT_EQ(diagnostics.guess("glas", names), " (did you mean \"glass\"?)");
    for (int i = 0; i < 50; ++i) diagnostics.guess("glas", names);
    EXPECT_LT(asked, 6);
    std::vector<std::string> many(1234, "a");
    EXPECT_TRUE(list_of(many).ends_with(", a and 1134 more"));
}

TEST(Error, WarningsToo) {
    Sources sources;
    const uint32_t file = sources.add_owned("a.pbrt", "one\ntwo\n");
    Diagnostics diagnostics(sources);
    diagnostics.warning({file, 4}, "later");
    diagnostics.warning({file, 0}, "earlier");
    ASSERT_EQ(diagnostics.warnings().size(), 2u);
    EXPECT_TRUE(diagnostics.warnings()[0].starts_with("a.pbrt:1:1: warning: earlier"));
    for (size_t i = 0; i < Diagnostics::kMaxWarnings; ++i) diagnostics.warning({file, 4}, "many");
    EXPECT_EQ(diagnostics.warnings().size(), Diagnostics::kMaxWarnings + 1);
    EXPECT_EQ(diagnostics.warnings().back(), "warning: further warnings are not shown");
}

// The errors that are shown are the scene's first, even if a later stage finds them after many others.
TEST(Error, TheFirstOfManyAreShown) {
    Sources sources;
    const uint32_t file = sources.add_owned("a.pbrt", std::string(200, '\n'));
    Diagnostics diagnostics(sources);
    for (uint64_t i = 60; i > 0; --i) diagnostics.error({file, i - 1}, "line " + std::to_string(i));
    const std::vector<std::string> errors = diagnostics.errors();
    ASSERT_EQ(errors.size(), Diagnostics::kMaxShown);
    for (size_t i = 0; i < errors.size(); ++i)
        EXPECT_NE(errors[i].find("line " + std::to_string(i + 1) + "\n"), std::string::npos);
    EXPECT_EQ(diagnostics.error_count(), 60u);
}

}  // namespace

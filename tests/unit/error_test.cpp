// Diagnostics: what is told of a scene's mistakes, in the order in which a reader meets them.
#include "core/error.h"

#include <gtest/gtest.h>

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

// The errors that are shown are the first of the scene, even where a later stage finds them after many others.
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

// Each scenes/*.pbrt has an error. Its first lines say how this error must be reported:
//   # expect: LINE:COLUMN: beginning of the message
// Exactly these errors are reported, and each caret is below its location.
#include "core/scene/description.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace lampyris;

namespace {

const std::filesystem::path kFolder = std::filesystem::path(LAMPYRIS_SOURCE_DIR) / "tests/errors/scenes";

std::vector<std::string> scene_names() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(kFolder))
        if (entry.path().extension() == ".pbrt") names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

std::string read_text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

class SceneErrors : public testing::TestWithParam<std::string> {};

}  // namespace

TEST_P(SceneErrors, AreToldWhereTheyAre) {
    const std::string name = GetParam() + ".pbrt";
    const std::string text = read_text(kFolder / name);
    const std::vector<std::string> source = lines_of(text);
    std::vector<std::string> expected;
    const std::string mark = "# expect: ";
    for (const std::string& line : source)
        if (line.starts_with(mark)) expected.push_back(line.substr(mark.size()));
    ASSERT_FALSE(expected.empty()) << name << " does not say what to expect";

    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    parse_scene_text(name, text, kFolder.string(), sources, diagnostics);
    std::string all;
    for (const std::string& error : diagnostics.errors()) all += error + "\n";
    ASSERT_EQ(diagnostics.error_count(), expected.size()) << all;
    for (size_t i = 0; i < expected.size(); ++i) {
        const std::string error = diagnostics.errors()[i];
        std::istringstream place(expected[i]);
        size_t line = 0, column = 0;
        char colon = 0;
        place >> line >> colon >> column >> colon;
        std::string message;
        std::getline(place >> std::ws, message);
        const std::string head =
            name + ":" + std::to_string(line) + ":" + std::to_string(column) + ": error: " + message;
        EXPECT_TRUE(error.starts_with(head)) << "expected " << head << "\nfound    " << error;
        const std::vector<std::string> shown = lines_of(error);
        ASSERT_EQ(shown.size(), 3u) << error;
        ASSERT_LE(line, source.size());
        EXPECT_EQ(shown[1], source[line - 1]);
        EXPECT_EQ(shown[2], std::string(column - 1, ' ') + "^");
    }
}

INSTANTIATE_TEST_SUITE_P(Files, SceneErrors, testing::ValuesIn(scene_names()), [](const auto& info) {
    std::string name = info.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

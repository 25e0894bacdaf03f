// Every damaged scene file is either an error or renders: parse, build, and a 4x4 render of scenes that contain every shape,
// material, texture, light, camera and filter, with words removed or swapped, and numbers replaced. The seeds are those of the
// fuzzer (tests/fuzz/corpus/scene); the damage of a round depends only on the round's number. LAMPYRIS_MUTATION_ROUNDS sets the
// number of rounds. Sanitizers check along in a build that has them.
#include "core/render/film.h"
#include "core/render/integrator.h"
#include "core/scene/build.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

namespace lampyris {
namespace {

const std::filesystem::path kCorpus = std::filesystem::path(LAMPYRIS_SOURCE_DIR) / "tests/fuzz/corpus/scene";

const char* const kReplacements[] = {"0",          "-1",          "1e30", "1e-30",  "nan",   "inf",
                                     "2147483647", "-2147483648", "1e39", "1e18",   "-0",    "\"\"",
                                     "\"none\"",   "[",           "]",    "3.5",    "-1e38", "4294967295",
                                     "1e-45",      "\"texture\"", "[ ]",  "100000", "0.5",   "1"};

// Words, with strings kept whole and line ends as words of their own.
std::vector<std::string> words_of(const std::string& text) {
    std::vector<std::string> words;
    std::string word;
    bool quoted = false;
    const auto end_word = [&] {
        if (!word.empty()) words.push_back(std::move(word));
        word.clear();
    };
    for (const char c : text) {
        if (c == '"') quoted = !quoted;
        if (!quoted && (c == ' ' || c == '\n')) {
            end_word();
            if (c == '\n') words.emplace_back("\n");
        } else {
            word += c;
        }
    }
    end_word();
    return words;
}

bool is_number(const std::string& word) {
    return !word.empty() && (word[0] == '-' || (word[0] >= '0' && word[0] <= '9'));
}

std::string damaged(std::vector<std::string> words, std::mt19937& random) {
    const auto below = [&](size_t n) { return size_t(random() % n); };
    // In half of the scenes only numbers are replaced: those get past the parser.
    const bool numbers_only = below(2) == 0;
    for (size_t k = 1 + below(3); k > 0; --k) {
        size_t i = below(words.size());
        switch (numbers_only ? 4 : below(6)) {
            case 0: words.erase(words.begin() + std::ptrdiff_t(i)); break;
            case 1: words[i] = words[below(words.size())]; break;
            case 2: words.insert(words.begin() + std::ptrdiff_t(i), words[below(words.size())]); break;
            case 3: words[i][below(words[i].size())] = char(32 + below(95)); break;
            default:
                while (!is_number(words[i])) i = below(words.size());
                words[i] = kReplacements[below(std::size(kReplacements))];
        }
    }
    std::string text;
    for (const std::string& word : words) text += word + (word == "\n" ? "" : " ");
    return text;
}

// Runs all stages. Returns whether there was a picture.
bool survive(Device& device, const std::string& text, bool skip_unsupported) {
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    diagnostics.set_skip_unsupported(skip_unsupported);
    BuildOptions options;
    options.resolution = {4, 4};
    try {
        BuiltScene built =
            build_scene(parse_scene_text("m.pbrt", text, kCorpus.string(), sources, diagnostics), options, diagnostics);
        diagnostics.throw_if_errors();
        const IntegratorFactory& factory = integrators().require("path");
        const std::unique_ptr<Integrator> integrator = factory.create();
        set_defaults(integrator->parameters(), factory.fields);
        const DeviceSceneHandle device_scene = device.upload(built.scene);
        Film film(device, built.scene, built.settings.crop);
        RenderSession session(device, built.scene, device_scene, film, {1, {}, {}});
        integrator->render(session);
        film.download();
        film.image();
        return true;
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()), "");
        return false;
    }
}

TEST(Mutation, DamagedScenesAreErrorsOrRender) {
    const char* const asked = std::getenv("LAMPYRIS_MUTATION_ROUNDS");
    const int rounds = asked ? std::atoi(asked) : 1500;
    const std::unique_ptr<Device> device = create_device("cpu", {});
    std::vector<std::vector<std::string>> seeds;
    for (const auto& entry : std::filesystem::directory_iterator(kCorpus)) {
        if (entry.path().extension() != ".pbrt") continue;
        std::ifstream file(entry.path());
        const std::string text{std::istreambuf_iterator<char>(file), {}};
        EXPECT_TRUE(survive(*device, text, false)) << entry.path() << " is whole, and does not render";
        seeds.push_back(words_of(text));
    }
    std::sort(seeds.begin(), seeds.end());
    ASSERT_GE(seeds.size(), 3u);
    int rendered = 0;
    for (int round = 0; round < rounds; ++round) {
        std::mt19937 random{uint32_t(round)};
        const std::string text = damaged(seeds[size_t(round) % seeds.size()], random);
        try {
            if (survive(*device, text, round % 2 == 1)) ++rendered;
        } catch (const std::exception& error) {
            ADD_FAILURE() << "round " << round << ": " << error.what() << "\n" << text;
        }
    }
    // If all runs were errors, or none, the damage would not be of the right kind.
    EXPECT_GT(rendered, rounds / 10);
    EXPECT_LT(rendered, rounds * 9 / 10);
}

}  // namespace
}  // namespace lampyris

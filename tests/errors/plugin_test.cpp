// Files that are not plugins are refused with a message, and before any of their code runs.
#include "core/base/plugin.h"

#include "core/base/error.h"
#include "support/temporary_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

namespace lampyris {
namespace {

class PluginErrors : public testing::Test {
 protected:
    std::string write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return folder_ / name;
    }
    static std::string message(const std::string& file) {
        try {
            load_plugin(file);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no error";
    }
    // The text before the ABI in a plugin's file. It is assembled here, so that this program, which is not a plugin, does not
    // contain it as a whole: in one of the tests, it is refused for that reason.
    static std::string mark() { return std::string("lampyris_plugin") + "_abi="; }
    const test::TemporaryFolder folder_;
};

TEST_F(PluginErrors, AMissingFileIsNamed) {
    EXPECT_EQ(message("nowhere/x.so"), "nowhere/x.so: error: there is no such plugin file");
}

TEST_F(PluginErrors, AFolderIsNoPlugin) {
    EXPECT_EQ(message(folder_.string()),
              folder_.string() + ": error: it is a folder; a plugin is a shared object (.so)");
}

TEST_F(PluginErrors, ATextIsNoSharedObject) {
    const std::string file = write("text.so", mark() + "0.1.0");
    EXPECT_EQ(message(file), file + ": error: this is no shared object");
}

TEST_F(PluginErrors, AnotherProgramsFileLacksTheSymbol) {
    EXPECT_NE(message("/proc/self/exe").find("no Lampyris plugin: it has no symbol lampyris_plugin_abi"),
              std::string::npos);
    const std::string library = LAMPYRIS_BINARY_DIR "/liblampyris.so";
    EXPECT_NE(message(library).find("no Lampyris plugin"), std::string::npos);
}

TEST_F(PluginErrors, APluginForAnotherVersionIsNotLoaded) {
    const std::string file = write("old.so", "\177ELF junk " + mark() + "0.0.9 (abc)" + '\0' + "more");
    EXPECT_EQ(message(file),
              fmt::format("{}: error: this plugin was built for Lampyris 0.0.9 (abc), and this is Lampyris {}; "
                          "build it again",
                          file, plugin_abi()));
}

TEST_F(PluginErrors, ADamagedPluginIsTheLoadersError) {
    const std::string file = write("damaged.so", "\177ELF junk " + mark() + std::string(plugin_abi()) + '\0');
    EXPECT_TRUE(message(file).starts_with(file + ": error: "));
    EXPECT_NE(message(file), "no error");
}

TEST_F(PluginErrors, AFileCutShortInsideItsMarkIsRefused) {
    const std::string file = write("cut.so", "\177ELF junk " + mark() + "0.");
    EXPECT_NE(message(file).find("was built for Lampyris 0.,"), std::string::npos);
}

TEST_F(PluginErrors, APathListTakesFoldersFilesAndEmptyEntries) {
    write("readme.txt", "not looked at");
    EXPECT_NO_THROW(load_plugin_path(""));
    EXPECT_NO_THROW(load_plugin_path(":" + folder_.string() + "::"));
    const std::string bad = write("bad.so", "text");
    try {
        load_plugin_path("/usr/lib/nothing-here.so:" + folder_.string());
        FAIL() << "a missing entry must be told";
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()), "/usr/lib/nothing-here.so: error: there is no such plugin file");
    }
    EXPECT_THROW(load_plugin_path(folder_.string()), InputError);
}

}  // namespace
}  // namespace lampyris

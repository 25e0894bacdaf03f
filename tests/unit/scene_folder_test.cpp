// Which files a scene may read.
#include "core/scene/scene_folder.h"

#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace lampyris::test {
namespace {

namespace fs = std::filesystem;

class SceneFolderTest : public testing::Test {
 protected:
    SceneFolderTest() {
        for (const char* name : {"scene/below", "scenes", "other"}) fs::create_directories(at(name));
        for (const char* name : {"scene/a", "scene/below/a", "scenes/a", "other/a"}) std::ofstream(at(name)) << "text";
    }
    std::string at(const std::string& name) const { return root_ / name; }
    // Whether a scene in the folder "scene" may read what it calls `name`.
    bool may_read(const std::string& name, const std::vector<std::string>& allowed = {}) const {
        const SceneFolder folder(at("scene"), allowed);
        return folder.why_refused(folder.path(name)).empty();
    }
    const TemporaryFolder root_;
};

TEST_F(SceneFolderTest, ItsOwnFiles) {
    for (const std::string name : {"a", "below/a", "./a", "below/../a", "none", "none/none", "../scene/a", "."})
        EXPECT_TRUE(may_read(name)) << name;
    EXPECT_TRUE(may_read(at("scene/a")));
}

TEST_F(SceneFolderTest, NothingElse) {
    for (const std::string name : {"../other/a", "..", "../scenes/a", "below/../../other/a", "/etc/passwd", "/",
                                   "none/../../other/a", "../other/none"})
        EXPECT_FALSE(may_read(name)) << name;
    EXPECT_FALSE(may_read(at("scenes/a"))) << "the folder's name is only the beginning of this one's";
}

TEST_F(SceneFolderTest, LinksAreFollowed) {
    fs::create_symlink(at("other/a"), at("scene/out"));
    fs::create_directory_symlink(at("other"), at("scene/folder"));
    fs::create_symlink(at("scene/a"), at("scene/in"));
    fs::create_symlink(at("other/none"), at("scene/dangling"));
    fs::create_symlink("loop", at("scene/loop"));
    EXPECT_TRUE(may_read("in"));
    for (const char* name : {"out", "folder/a", "folder/none", "dangling", "loop"})
        EXPECT_FALSE(may_read(name)) << name;
    fs::create_symlink("below/new", at("scene/dangling-in"));
    fs::create_symlink("dangling-in", at("scene/chain"));
    EXPECT_TRUE(may_read("dangling-in"));
    EXPECT_TRUE(may_read("chain"));
    // A link to the scene's folder is the scene's folder.
    fs::create_directory_symlink(at("scene"), at("alias"));
    const SceneFolder folder(at("alias"));
    EXPECT_EQ(folder.why_refused(folder.path("a")), "");
    EXPECT_EQ(folder.why_refused(at("scene/a")), "");
}

TEST_F(SceneFolderTest, AllowedFolders) {
    EXPECT_TRUE(may_read("../other/a", {at("other")}));
    EXPECT_TRUE(may_read("../other/a", {at("scenes"), at("other") + "/"}));
    EXPECT_TRUE(may_read("/etc/passwd", {"/"}));
    EXPECT_FALSE(may_read("../other/a", {at("scenes")}));
    EXPECT_FALSE(may_read("../other/a", {""}));
}

TEST_F(SceneFolderTest, TheReasonDoesNotTellWhetherThereIsSuchAFile) {
    const SceneFolder folder(at("scene"));
    EXPECT_EQ(folder.why_refused(at("other/a")), folder.why_refused(at("other/none")));
    EXPECT_NE(folder.why_refused(at("other/a")).find("--allow FOLDER"), std::string::npos);
    // By a way there and back.
    for (const std::string way :
         {"../other/a/../../scene/a", "../other/none/../../scene/a", "../other/../scene/a", "../none/../scene/a"}) {
        EXPECT_FALSE(may_read(way)) << way;
        EXPECT_FALSE(may_read(at("scene/") + way)) << way;
    }
}

TEST_F(SceneFolderTest, HoweverItIsCalled) {
    const fs::path before = fs::current_path();
    fs::current_path(at("other"));
    for (const std::string name : {"../scene", "../other/../scene", "./../scene/below/.."}) {
        const SceneFolder folder(name);
        EXPECT_EQ(folder.why_refused(folder.path("a")), "") << name;
        EXPECT_EQ(folder.why_refused(folder.path("below/a")), "") << name;
        EXPECT_EQ(folder.why_refused(at("scene/a")), "") << name;
        EXPECT_NE(folder.why_refused(folder.path("../other/a")), "") << name;
    }
    fs::current_path(before);
}

TEST_F(SceneFolderTest, WithoutAFolderItIsTheWorkingOne) {
    for (const SceneFolder& folder : {SceneFolder(), SceneFolder("")}) {
        EXPECT_EQ(folder.why_refused(folder.path("a")), "");
        EXPECT_NE(folder.why_refused(folder.path("../a")), "");
    }
}

}  // namespace
}  // namespace lampyris::test

// Files that appear as a whole or not at all.
#include "core/base/file.h"

#include "core/base/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

namespace lampyris {
namespace {

namespace fs = std::filesystem;

class FileTest : public testing::Test {
 protected:
    FileTest() : folder_(fs::temp_directory_path() / fmt::format("lampyris-file-test-{}", ::getpid())) {
        fs::remove_all(folder_);
        fs::create_directory(folder_);
    }
    ~FileTest() override { fs::remove_all(folder_); }
    std::string at(const std::string& name) const { return (folder_ / name).string(); }
    static std::string content(const std::string& path) {
        std::ifstream stream(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    // The names in the folder.
    std::vector<std::string> names() const { return files_beside(folder_ / "any"); }
    static std::string error_of(const std::string& path) {
        try {
            write_file_atomically(path, "new");
        } catch (const Error& error) {
            return error.what();
        }
        return "no error";
    }

 private:
    fs::path folder_;
};

TEST_F(FileTest, IsReplacedAsAWhole) {
    write_file_atomically(at("a"), "one");
    EXPECT_EQ(content(at("a")), "one");
    ASSERT_EQ(::chmod(at("a").c_str(), 0640), 0);
    std::ifstream reader(at("a"));  // sees what was there when it was opened
    write_file_atomically(at("a"), "another");
    EXPECT_EQ(content(at("a")), "another");
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(reader), {}), "one");
    struct stat info {};
    ASSERT_EQ(::stat(at("a").c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777, 0640u);
    EXPECT_EQ(names(), std::vector<std::string>{"a"});
}

TEST_F(FileTest, LinksAreFollowed) {
    fs::create_symlink("target", at("link"));  // which is not there yet
    write_file_atomically(at("link"), "content");
    EXPECT_EQ(content(at("target")), "content");
    EXPECT_TRUE(fs::is_symlink(at("link")));
    write_file_atomically(at("link"), "more");  // which is there now
    EXPECT_EQ(content(at("target")), "more");
    EXPECT_EQ(names(), (std::vector<std::string>{"link", "target"}));
    fs::create_symlink("round", at("round"));
    EXPECT_NE(error_of(at("round")).find("symbolic links"), std::string::npos) << error_of(at("round"));
    EXPECT_THROW(check_writable(at("round")), MachineError);
}

TEST_F(FileTest, NamesMayBeAsLongAsTheSystemsAre) {
    const std::string longest(255, 'x');
    check_writable(at(longest));
    write_file_atomically(at(longest), "content");
    EXPECT_EQ(content(at(longest)), "content");
    EXPECT_EQ(names().size(), 1u);
    EXPECT_THROW(check_writable(at(longest + "x")), MachineError);
    EXPECT_NE(error_of(at(longest + "x")), "no error");
    EXPECT_EQ(names().size(), 1u);
}

TEST_F(FileTest, WhatCannotBeWrittenLeavesNothing) {
    EXPECT_NE(error_of(at("none/a")), "no error");
    EXPECT_NE(error_of(at("")), "no error");
    EXPECT_THROW(check_writable(at("none/a")), InputError);
    fs::create_directory(at("b"));
    EXPECT_NE(error_of(at("b")), "no error");
    EXPECT_NE(error_of("/dev/full").find("No space left"), std::string::npos);
    EXPECT_EQ(names(), std::vector<std::string>{"b"});
}

TEST_F(FileTest, APipeIsWrittenIfItIsRead) {
    ASSERT_EQ(::mkfifo(at("pipe").c_str(), 0600), 0);
    EXPECT_NE(error_of(at("pipe")).find("no program reads from this pipe"), std::string::npos);
    const std::string sent(1 << 20, 'x');  // more than a pipe holds
    const int reader = ::open(at("pipe").c_str(), O_RDONLY | O_NONBLOCK);
    ASSERT_GE(reader, 0);
    ASSERT_EQ(::fcntl(reader, F_SETFL, 0), 0);
    std::thread writer([&] { write_file_atomically(at("pipe"), sent); });
    std::string received(sent.size(), ' ');
    size_t got = 0;
    while (got < sent.size()) {
        const ssize_t n = ::read(reader, received.data() + got, received.size() - got);
        if (n > 0)
            got += size_t(n);
        else if (n < 0)
            break;
        else
            std::this_thread::yield();  // the writer has not opened it yet
    }
    writer.join();
    ::close(reader);
    EXPECT_EQ(received, sent);
}

TEST_F(FileTest, PipesAndDevicesAreNotRead) {
    ASSERT_EQ(::mkfifo(at("pipe").c_str(), 0600), 0);
    EXPECT_EQ(why_not_readable(at("pipe")), "it is not a regular file");
    EXPECT_EQ(why_not_readable("/dev/zero"), "it is not a regular file");
    EXPECT_EQ(why_not_readable(at("")), "it is a folder");
    EXPECT_EQ(why_not_readable(at("none")), "");
    write_file_atomically(at("a"), "content");
    EXPECT_EQ(why_not_readable(at("a")), "");
}

}  // namespace
}  // namespace lampyris

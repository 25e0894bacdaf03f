// The lampyris program: finds the subcommand, and turns exceptions into a message and an exit code.
#include "commands/command.h"
#include "commands/console.h"
#include "commands/foreign_words.h"
#include "core/base/background.h"
#include "core/base/error.h"
#include "core/base/version.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace lampyris {

std::vector<Command>& commands() {
    static std::vector<Command> list;  // function-local, because commands register before main, in no defined order
    return list;
}

namespace {

// CLI11 would only say that a subcommand is required.
void check_command_name(const CLI::App& app, int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-') return;
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    if (std::find(names.begin(), names.end(), argv[1]) != names.end()) return;
    throw InputError(fmt::format("lampyris: error: there is no command '{}'{}; the commands are {}", argv[1],
                                 did_you_mean(argv[1], names), list_of(names)));
}

// A suggestion for an unknown option: it is another renderer's name, or similar to one of ours.
std::string near_option(const CLI::App& app) {
    for (const std::string& text : app.remaining(true)) {
        if (const std::string advice = advice_on_option(text.substr(0, text.find('='))); !advice.empty()) return advice;
        if (!text.starts_with("--")) continue;
        std::vector<std::string> names;
        const CLI::App* command = &app;
        while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
        for (const CLI::Option* option : command->get_options())
            for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        return did_you_mean(text.substr(0, text.find('=')), names);
    }
    return {};
}

// "help COMMAND" is "COMMAND --help".
std::vector<char*> without_help(int argc, char** argv) {
    static char option[] = "--help";
    std::vector<char*> words(argv, argv + argc);
    if (argc < 2 || std::string_view(argv[1]) != "help") return words;
    words.erase(words.begin() + 1);
    words.push_back(option);
    return words;
}

int run_command_line(int argc, char** argv) {
    std::vector<char*> words = without_help(argc, argv);
    argc = int(words.size());
    argv = words.data();
    CLI::App app("Lampyris, a laboratory for light transport.", "lampyris");
    app.set_version_flag("--version", fmt::format("lampyris {}", version()));
    app.require_subcommand(1);
    app.get_formatter()->column_width(36);
    app.footer("'lampyris help COMMAND' lists a command's options.");
    std::function<int()> run;
    for (const Command& command : commands()) command.add(app, run);
    check_command_name(app, argc, argv);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        // Help and version requests are not errors; every other exception here is a wrong argument.
        if (error.get_exit_code() == 0) return app.exit(error);
        throw InputError(
            fmt::format("lampyris: error: {}{}; --help lists what there is", error.what(), near_option(app)));
    }
    const int code = run();
    // A result that could not be written (a full disk, say) must not look like success.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
        throw MachineError(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
    return code;
}

int report(const std::string& message, ExitCode code) {
    std::fflush(stdout);
    // Messages of libraries and of the file system do not say that they are errors.
    const bool says_so = message.find("error: ") != std::string::npos;
    tell_last(fmt::format("{}{}\n", says_so ? "" : "lampyris: error: ", message));
    return int(code);
}

constexpr double kWaitForBackground = 1.0;  // seconds

std::string unexpected(const std::exception& error) {
    return fmt::format("lampyris: error: {} (this should not have happened: please report it)", error.what());
}

int run_and_report(int argc, char** argv) {
    try {
        return run_command_line(argc, argv);
    } catch (const Error& error) {
        return report(error.what(), error.code());
    } catch (const std::system_error& error) {
        // fmt::print throws if the output cannot be written.
        if (std::ferror(stdout) == 0) return report(unexpected(error), ExitCode::kMachineCannot);
        return report(fmt::format("cannot write to standard output: {}", error.code().message()),
                      ExitCode::kMachineCannot);
    } catch (const std::bad_alloc&) {
        return report("lampyris: error: out of memory", ExitCode::kMachineCannot);
    } catch (const std::exception& error) {
        return report(unexpected(error), ExitCode::kMachineCannot);
    }
}

}  // namespace
}  // namespace lampyris

int main(int argc, char** argv) {
    using namespace lampyris;
    prepare_console();
    const int code = run_and_report(argc, argv);
    // A kernel that is being compiled in the background is for the next run. Whoever interrupts this one does not wait for it.
    if (background_ends_within(code == int(ExitCode::kInterrupted) ? 0.0 : kWaitForBackground)) return code;
    std::fflush(nullptr);
    _exit(code);
}

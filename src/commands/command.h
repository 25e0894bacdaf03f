// Subcommands of the lampyris program. A file in this folder defines one and registers it:
//
//     void add_hello(CLI::App& parent, std::function<int()>& run) {
//         auto name = std::make_shared<std::string>();
//         CLI::App* command = parent.add_subcommand("hello", "Greet");
//         command->add_option("NAME", *name, "whom")->required();
//         command->callback([&run, name] { run = [name] { fmt::print("hello, {}\n", *name); return 0; }; });
//     }
//     REGISTER_COMMAND(add_hello);
//
// `run` is called after the whole command line was parsed. It returns the exit code, and throws Error on failure.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <vector>

namespace lampyris {

using AddCommand = void (*)(CLI::App& parent, std::function<int()>& run);

struct Command {
    AddCommand add;
};

std::vector<Command>& commands();  // in no particular order

struct CommandRegistration {
    explicit CommandRegistration(AddCommand add) { commands().push_back({add}); }
};

}  // namespace lampyris

#define REGISTER_COMMAND(add_function) \
    static const ::lampyris::CommandRegistration registered_##add_function { &add_function }

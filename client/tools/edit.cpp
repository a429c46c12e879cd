#include "client/tools/edit.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <vector>

#include "client/edit/interpreter.h"
#include "client/edit/prompt.h"

namespace tessera::tools {

namespace {

constexpr const char* EditName = "edit";

struct EditOptions {
    std::optional<std::string> script;
    std::vector<std::string> commands;
    SceneAddress address{.master = {}, .keys = {}, .user = "editor", .name = "editor", .title = "scene"};
};

int report(const Error& error) {
    return report_error(EditName,
                        error.code() == ErrorCode::InvalidInput ? ExitBadScript : exit_code(error.code()),
                        error.what());
}

void print(std::string_view text) {
    std::cout << text << std::flush;
}

Expected<std::string> read_script(const std::string& name) {
    std::error_code unreadable;
    std::ifstream file;
    if (name != "-") {
        if (std::filesystem::is_directory(name, unreadable)) {
            return failure(ErrorCode::NotFound, "'" + name + "' is a folder: give a script file");
        }
        file.open(name, std::ios::binary);
        if (!file)
            return failure(ErrorCode::NotFound, "cannot read the script '" + name + "': check the name");
    }
    std::istream& stream = name == "-" ? std::cin : file;
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (stream.bad()) return failure(ErrorCode::Io, "'" + name + "' cannot be read: I/O error");
    return text;
}

// Each option -c is a line of one script.
std::string joined(const std::vector<std::string>& commands) {
    std::string text;
    for (const std::string& command : commands) text += command + "\n";
    return text;
}

int run_script(edit::EditTarget& target, const std::string& name, const std::string& text) {
    edit::EditInterpreter interpreter(target, print);
    const auto done = interpreter.run_script(name, text);
    return done ? 0 : report(done.error());
}

int run_prompt(edit::EditTarget& target) {
    edit::EditInterpreter interpreter(target, print);
    edit::Prompt prompt(stdin, stdout, edit::default_history_file(),
                        [&](std::string_view text, std::size_t cursor) {
                            return edit::complete(text, cursor, interpreter.scene());
                        });
    std::cout << "'help' lists the commands, Tab completes, Ctrl-D quits.\n";
    while (!interpreter.has_quit()) {
        const auto line =
            prompt.read(interpreter.is_in_transaction() ? "tessera (transaction)> " : "tessera> ");
        if (!line) {
            std::cout << "\n";
            break;
        }
        if (const auto done = interpreter.run_line(*line); !done) std::cerr << done.error().what() << "\n";
    }
    if (interpreter.is_in_transaction())
        std::cerr << "the open transaction was discarded: it was not committed\n";
    return 0;
}

int run(const EditOptions& options, const ConnectScene& connect) {
    if (options.script && !options.commands.empty()) {
        return report_error(EditName, cli::ExitUsage, "a script and -c exclude each other");
    }
    const bool is_typed = !options.script && options.commands.empty() && ::isatty(STDIN_FILENO) != 0;
    const std::string name = !options.commands.empty() ? "-c" : options.script.value_or("-");
    try {
        std::string text = joined(options.commands);
        if (!is_typed && options.commands.empty()) {
            auto script = read_script(name);
            if (!script)
                return report_error(EditName, exit_code(script.error().code()), script.error().what());
            text = std::move(*script);
        }
        const std::unique_ptr<edit::EditTarget> target = connect(options.address);
        return is_typed ? run_prompt(*target) : run_script(*target, name, text);
    } catch (const Error& error) {
        return report_error(EditName, exit_code(error.code()), error.what());
    }
}

}  // namespace

Command edit_command(cli::CommandLine& program, ConnectScene connect) {
    const auto options = std::make_shared<EditOptions>();
    cli::CommandLine& command = program.command(
        EditName,
        "Edit a live scene with a script, with single commands, or at a prompt (type 'help' there).");
    command.optional_positional(
        "SCRIPT", "file with one command per line, - for standard input; default: an interactive prompt",
        options->script);
    command.option("-c",
                   "run this command instead of a script; may be given several times, all in one transaction",
                   options->commands);
    command.option("--master", "endpoint of the cluster's master: tcp://host:port", options->address.master);
    command.option("--keys", "keys for that cluster: a key folder or an exported key file",
                   options->address.keys);
    command.option("--user", "name of the key to use from a key folder", options->address.user);
    command.option("--name", "your name, as other members see it", options->address.name);
    command.option("--scene", "title of the scene, if a new one is opened", options->address.title);
    command.required("--master");
    command.examples({"tessera edit --master tcp://render-1:7420 --keys ~/.tessera",
                      "tessera edit tour.txt --master tcp://127.0.0.1:7420",
                      "tessera edit --master tcp://127.0.0.1:7420 -c 'load room.glb' -c 'save copy.tessera'",
                      "tessera edit --master tcp://127.0.0.1:7420 -c 'help all'"});
    return {EditName,
            [options, connect = std::move(connect)](std::string_view) { return run(*options, connect); }};
}

}  // namespace tessera::tools

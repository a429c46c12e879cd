#include "mediator/program/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <map>
#include <ostream>

#include "mediator/base/error.h"
#include "mediator/base/nearest.h"
#include "mediator/base/old_names.h"
#include "mediator/program/commit.h"

namespace tessera::cli {

struct CommandLine::Implementation {
    CLI::App* app = nullptr;
    std::unique_ptr<CLI::App> owned;  // of the program itself
    std::vector<std::unique_ptr<CommandLine>> commands;
    std::string config;
    std::map<std::string, std::string> alone;  // options with an optional value, and their value without one
};

namespace {

std::vector<std::string> option_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
    return names;
}

std::vector<std::string> command_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    return names;
}

bool looks_like_option(const std::string& word) {
    return word.size() > 1 && word[0] == '-' && word != "--" && !std::isdigit(word[1]) && word[1] != '.';
}

std::string suggestion(const std::string& word, const std::vector<std::string>& candidates) {
    const std::optional<std::string> best = nearest(word, candidates);
    return best ? "; did you mean '" + *best + "'?" : "; see --help";
}

// An error for the first unknown word, with the closest known one; "" if all are known.
std::string unknown_word(const CLI::App& program, const std::vector<std::string>& words) {
    const CLI::App* app = &program;
    for (const std::string& word : words) {
        const std::vector<std::string> commands = command_names(*app);
        if (looks_like_option(word)) {
            const std::string name = word.substr(0, word.find('='));
            const std::vector<std::string> names = option_names(*app);
            if (std::find(names.begin(), names.end(), name) == names.end()) {
                return "there is no option '" + name + "'" + suggestion(name, names);
            }
        } else if (!commands.empty()) {
            if (std::find(commands.begin(), commands.end(), word) != commands.end()) {
                app = app->get_subcommand(word);
            } else if (&word == words.data()) {  // later words may be values of options
                return "there is no command '" + word + "'" + suggestion(word, commands);
            }
        }
    }
    return {};
}

std::optional<std::string> config_path(const std::vector<std::string>& words) {
    std::optional<std::string> path;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words[i] == "--config" && i + 1 < words.size()) path = words[i + 1];
        if (words[i].starts_with("--config=")) path = words[i].substr(9);
    }
    return path;
}

// Inserts each section's words right after its command, so that typed options come later and override them.
std::vector<std::string> with_config(const CLI::App& program, const std::vector<std::string>& typed,
                                     const std::vector<ConfigSection>& sections) {
    const auto append_section = [&](std::vector<std::string>& words, const std::string& command) {
        for (const ConfigSection& section : sections) {
            if (section.command == command)
                words.insert(words.end(), section.words.begin(), section.words.end());
        }
    };
    std::vector<std::string> words;
    append_section(words, "");
    const CLI::App* app = &program;
    std::string path;
    for (const std::string& word : typed) {
        words.push_back(word);
        const std::vector<std::string> commands = command_names(*app);
        if (std::find(commands.begin(), commands.end(), word) == commands.end()) continue;
        app = app->get_subcommand(word);
        path += (path.empty() ? "" : " ") + word;
        append_section(words, path);
    }
    return words;
}

// Replaces old names of commands and options by the present ones, with a hint for each.
void replace_old_names(const CLI::App& program, std::vector<std::string>& words, std::ostream& err) {
    const CLI::App* app = &program;
    for (std::string& word : words) {
        const std::size_t end = looks_like_option(word) ? word.find('=') : std::string::npos;
        const std::string name = word.substr(0, end);
        const std::vector<std::string> names =
            looks_like_option(word) ? option_names(*app) : command_names(*app);
        const auto knows = [&](std::string_view wanted) {
            return std::ranges::find(names, wanted) != names.end();
        };
        const auto present = present_name(looks_like_option(word) ? "option" : "command", name);
        if (present && !knows(name) && knows(*present)) {
            err << program.get_name() << ": " << old_name_hint(name, *present) << '\n';
            word.replace(0, name.size(), *present);
        }
        if (!looks_like_option(word) && knows(word)) app = app->get_subcommand(word);
    }
}

// The present path of a command whose last word may be an old name.
std::string present_command(const std::string& path) {
    const std::size_t last = path.rfind(' ') + 1;
    return path.substr(0, last) +
           std::string(present_name("command", path.substr(last)).value_or(path.substr(last)));
}

CLI::Option* single(CLI::Option* option) {
    return option->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)->capture_default_str();
}

}  // namespace

CommandLine::CommandLine(const std::string& program, const std::string& summary)
    : implementation_(std::make_unique<Implementation>()) {
    implementation_->owned = std::make_unique<CLI::App>(summary, program);
    implementation_->app = implementation_->owned.get();
    CLI::App& app = *implementation_->app;
    app.set_version_flag("--version", program + " " + version());
    option("--config", "read options from a TOML FILE; options on the command line override it",
           implementation_->config);
    app.get_option("--config")->type_name("FILE");
}

CommandLine::CommandLine(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}

CommandLine::~CommandLine() = default;

CommandLine& CommandLine::command(const std::string& name, const std::string& summary) {
    auto inner = std::make_unique<Implementation>();
    inner->app = implementation_->app->add_subcommand(name, summary);
    implementation_->app->require_subcommand(1);
    implementation_->commands.push_back(std::unique_ptr<CommandLine>(new CommandLine(std::move(inner))));
    return *implementation_->commands.back();
}

void CommandLine::option(const std::string& names, const std::string& help, std::string& value) {
    single(implementation_->app->add_option(names, value, help));
}
void CommandLine::option(const std::string& names, const std::string& help, double& value) {
    single(implementation_->app->add_option(names, value, help));
}
void CommandLine::option(const std::string& names, const std::string& help, std::uint32_t& value) {
    single(implementation_->app->add_option(names, value, help));
}
void CommandLine::option(const std::string& names, const std::string& help, std::uint64_t& value) {
    single(implementation_->app->add_option(names, value, help));
}
void CommandLine::option(const std::string& names, const std::string& help,
                         std::optional<std::string>& value) {
    single(implementation_->app->add_option(names, value, help));
}
void CommandLine::option(const std::string& names, const std::string& help, std::optional<double>& value) {
    single(implementation_->app->add_option(names, value, help));
}
void CommandLine::option(const std::string& names, const std::string& help,
                         std::optional<std::uint64_t>& value) {
    single(implementation_->app->add_option(names, value, help));
}

void CommandLine::option(const std::string& names, const std::string& help,
                         std::vector<std::string>& values) {
    implementation_->app->add_option(names, values, help)
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void CommandLine::choice(const std::string& names, const std::string& help, std::string& value,
                         const std::vector<std::string>& choices) {
    std::string list;
    for (const std::string& choice : choices) list += (list.empty() ? "" : "|") + choice;
    const auto check = [choices, list](const std::string& word) -> std::string {
        if (std::find(choices.begin(), choices.end(), word) != choices.end()) return {};
        const std::optional<std::string> best = nearest(word, choices);
        return "'" + word + "' is not one of " + list + (best ? "; did you mean '" + *best + "'?" : "");
    };
    single(implementation_->app->add_option(names, value, help))
        ->check(CLI::Validator(check, ""))
        ->type_name(list);
}

void CommandLine::option_with_default(const std::string& name, const std::string& help,
                                      std::optional<std::string>& value, const std::string& alone) {
    single(implementation_->app->add_option(name, value, help))->type_name("[=NAME]");
    implementation_->alone[name] = alone;
}

void CommandLine::flag(const std::string& names, const std::string& help, bool& value) {
    implementation_->app->add_flag(names, value, help);
}

void CommandLine::positional(const std::string& name, const std::string& help, std::string& value) {
    implementation_->app->add_option(name, value, help)->required();
}

void CommandLine::optional_positional(const std::string& name, const std::string& help,
                                      std::optional<std::string>& value) {
    implementation_->app->add_option(name, value, help);
}

void CommandLine::required(const std::string& option_name) {
    implementation_->app->get_option(option_name)->required();
}

void CommandLine::examples(const std::vector<std::string>& lines) {
    std::string footer = "Examples:";
    for (const std::string& line : lines) footer += "\n  " + line;
    implementation_->app->footer(footer);
}

std::optional<int> CommandLine::parse(int argc, const char* const* argv, std::ostream& out,
                                      std::ostream& err) {
    CLI::App& app = *implementation_->app;
    std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    const auto wrong = [&](const std::string& reason) {
        err << app.get_name() << ": " << reason << '\n';
        return ExitUsage;
    };
    try {
        replace_old_names(app, words, err);
        if (const std::optional<std::string> path = config_path(words)) {
            std::vector<ConfigSection> sections = read_config(*path);
            for (ConfigSection& section : sections) section.command = present_command(section.command);
            words = with_config(app, words, sections);
            replace_old_names(app, words, err);  // keys of the file
        }
        complete(words);
        app.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // CLI11 takes them last first
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success))
            return app.exit(error, out, err);
        const std::string unknown = unknown_word(app, words);
        return wrong(unknown.empty() ? error.what() + std::string("; see --help") : unknown);
    } catch (const Error& error) {
        return wrong(error.what());
    }
    return std::nullopt;
}

// "--denoise" becomes "--denoise=fdf": CLI11 would take the next word.
void CommandLine::complete(std::vector<std::string>& words) const {
    for (std::string& word : words) {
        if (const auto found = implementation_->alone.find(word); found != implementation_->alone.end())
            word += "=" + found->second;
    }
    for (const auto& command : implementation_->commands) {
        if (std::ranges::find(words, command->implementation_->app->get_name()) != words.end())
            command->complete(words);
    }
}

std::string CommandLine::chosen() const {
    const std::vector<CLI::App*> parsed = implementation_->app->get_subcommands();
    if (parsed.empty()) return {};
    for (const auto& command : implementation_->commands) {
        if (command->implementation_->app != parsed.front()) continue;
        const std::string inner = command->chosen();
        return parsed.front()->get_name() + (inner.empty() ? "" : " " + inner);
    }
    return {};
}

std::string version() {
    const std::string commit = Commit;
    return TESSERA_VERSION + (commit.empty() ? std::string() : " (" + commit + ")");
}

}  // namespace tessera::cli

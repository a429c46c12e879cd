#include "client/tools/keys_tool.h"

#include <iomanip>
#include <iostream>
#include <memory>
#include <vector>

#include "mediator/base/nearest.h"
#include "mediator/net/keys.h"

namespace tessera::tools {

namespace {

constexpr const char* KeysName = "keys";

std::string in_quotes(const std::string& text) {
    return "'" + text + "'";
}

int create(const KeysOptions& options, std::ostream& out) {
    net::KeyDirectory(options.folder).create();
    out << "created keys in " << in_quotes(options.folder)
        << ": one for the master, and one each for viewer, editor, node "
        << "and operator.\n"
        << "On this machine, pass --keys " << options.folder << " to every program. For another machine:\n"
        << "  tessera keys " << options.folder << " add NAME --role node --export NAME.key\n";
    return 0;
}

int add(const KeysOptions& options, std::ostream& out) {
    if (options.role.empty()) return report_error(KeysName, cli::ExitUsage, "add needs --role ROLE");
    if (options.export_file.empty()) return report_error(KeysName, cli::ExitUsage, "add needs --export FILE");
    net::KeyDirectory(options.folder).add(options.name, net::role_named(options.role), options.export_file);
    out << "added " << in_quotes(options.name) << " as " << options.role << ". Copy "
        << in_quotes(options.export_file)
        << " to the other machine over a secure channel, pass it to --keys there, and "
        << "send SIGHUP to a running tessera-master.\n";
    return 0;
}

int list(const KeysOptions& options, std::ostream& out) {
    out << std::left << std::setw(24) << "name" << std::setw(10) << "role"
        << "public key\n";
    for (const net::AllowedKey& key : net::KeyDirectory(options.folder).allowed()) {
        out << std::left << std::setw(24) << key.name << std::setw(10) << net::name(key.role)
            << key.public_key << "\n";
    }
    return 0;
}

int revoke(const KeysOptions& options, std::ostream& out) {
    net::KeyDirectory(options.folder).revoke(options.name);
    out << "revoked " << in_quotes(options.name) << ". Send SIGHUP to a running tessera-master.\n";
    return 0;
}

}  // namespace

int run_keys(const KeysOptions& options, std::ostream& out) {
    struct Action {
        const char* name;
        bool takes_name;
        int (*run)(const KeysOptions&, std::ostream&);
    };
    const std::vector<Action> actions{
        {"create", false, create}, {"add", true, add}, {"list", false, list}, {"revoke", true, revoke}};
    std::vector<std::string> names;
    for (const Action& action : actions) {
        names.push_back(action.name);
        if (options.action != action.name) continue;
        if (action.takes_name == options.name.empty()) {
            return report_error(KeysName, cli::ExitUsage,
                                options.action + (action.takes_name ? " needs a NAME" : " takes no NAME"));
        }
        try {
            return action.run(options, out);
        } catch (const Error& error) {
            return report_error(KeysName, exit_code(error.code()), error.what());
        }
    }
    const auto meant = nearest(options.action, names);
    return report_error(
        KeysName, cli::ExitUsage,
        "unknown action " + in_quotes(options.action) +
            (meant ? "; did you mean " + in_quotes(*meant) + "?" : ": use create, add, list or revoke"));
}

Command keys_command(cli::CommandLine& program) {
    const auto options = std::make_shared<KeysOptions>();
    cli::CommandLine& command = program.command(KeysName, "Create and manage the CURVE keys of a cluster.");
    command.positional("DIR", "key folder, on the master's machine", options->folder);
    command.option("ACTION", "create, add, list or revoke", options->action);
    command.option("NAME", "name of the key to add or revoke", options->name);
    command.choice("--role", "what the key may do", options->role, {"viewer", "editor", "node", "operator"});
    command.option("--export", "write the new key and the master's public key to this file",
                   options->export_file);
    command.examples({"tessera keys ~/.tessera", "tessera keys ~/.tessera list",
                      "tessera keys ~/.tessera add render-2 --role node --export render-2.key",
                      "tessera keys ~/.tessera revoke render-2"});
    return {KeysName, [options](std::string_view) { return run_keys(*options, std::cout); }};
}

}  // namespace tessera::tools

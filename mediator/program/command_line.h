#pragma once

#include <cstdint>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

// Shared by all programs: command-line options with help, and the same options from a file.
namespace tessera::cli {

// Exit codes of sysexits.h, as documented.
inline constexpr int ExitUsage = 64;
inline constexpr int ExitUnavailable = 69;
inline constexpr int ExitTryLater = 75;
inline constexpr int ExitRefused = 77;

// The options of a program or of one of its sub-commands. Values must outlive parse(), which writes only
// those that were given, so the previous value is the default. Names as "--size" or
// "-s,--size".
// --help, --version and --config FILE are added automatically.
class CommandLine {
  public:
    CommandLine(const std::string& program, const std::string& summary);
    ~CommandLine();
    CommandLine(const CommandLine&) = delete;
    CommandLine& operator=(const CommandLine&) = delete;

    // A sub-command, of this program or of this sub-command; then one must be chosen.
    CommandLine& command(const std::string& name, const std::string& summary);

    void option(const std::string& names, const std::string& help, std::string& value);
    void option(const std::string& names, const std::string& help, double& value);
    void option(const std::string& names, const std::string& help, std::uint32_t& value);
    void option(const std::string& names, const std::string& help, std::uint64_t& value);
    void option(const std::string& names, const std::string& help, std::optional<std::string>& value);
    void option(const std::string& names, const std::string& help, std::optional<double>& value);
    void option(const std::string& names, const std::string& help, std::optional<std::uint64_t>& value);
    void option(const std::string& names, const std::string& help,
                std::vector<std::string>& values);  // repeatable
    void choice(const std::string& names, const std::string& help, std::string& value,
                const std::vector<std::string>& choices);
    // --name=VALUE, or --name without a value for `alone`: the next word is never the value.
    void option_with_default(const std::string& name, const std::string& help,
                             std::optional<std::string>& value, const std::string& alone);
    void flag(const std::string& names, const std::string& help, bool& value);
    void positional(const std::string& name, const std::string& help, std::string& value);  // required
    void optional_positional(const std::string& name, const std::string& help,
                             std::optional<std::string>& value);
    void required(const std::string& option_name);  // makes an option one that must be given
    void examples(const std::vector<std::string>& lines);

    // Returns nothing to continue, else the exit code: 0 after --help and --version (written to `out`), 64 for wrong
    // options (reported on `err`, with the closest valid one). A --config file has the same names without dashes as TOML
    // keys, a table per sub-command; options on the command line override it.
    std::optional<int> parse(int argc, const char* const* argv, std::ostream& out, std::ostream& err);

    std::string chosen() const;  // after parse(): "render", "keys add"; "" without sub-commands

  private:
    struct Implementation;
    explicit CommandLine(std::unique_ptr<Implementation> implementation);
    void complete(std::vector<std::string>& words) const;
    std::unique_ptr<Implementation> implementation_;
};

std::string version();  // of this software, with its commit: "0.2.0 (1a2b3c4)"

// The options of a TOML file as words of a command line: [first] for the program itself, then per table (dots
// become spaces) its own. Throws Error{InvalidInput, NotFound} with file, line and reason.
struct ConfigSection {
    std::string command;  // "" = the program
    std::vector<std::string> words;
};
std::vector<ConfigSection> read_config(const std::string& path);

}  // namespace tessera::cli

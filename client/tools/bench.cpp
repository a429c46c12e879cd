#include "client/tools/bench.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "client/tools/child_process.h"

namespace tessera::tools {

bool names_bench(int argc, const char* const* argv) {
    int word = 1;
    while (word < argc && std::string_view(argv[word]).starts_with("--config"))
        word += std::string_view(argv[word]) == "--config" ? 2 : 1;
    return word < argc && std::string_view(argv[word]) == "bench";
}

int start_bench(char** argv) {
    const std::string path = (program_folder() / "tessera-bench").string();
    execv(path.c_str(), argv);
    if (errno == ENOENT) {
        return complain("bench", cli::ExitUnavailable,
                        "'" + path + "' is not there; deploy/setup.sh bench tessera-bench builds it");
    }
    return complain("bench", cli::ExitUnavailable, "cannot start '" + path + "': " + std::strerror(errno));
}

Command bench_command(cli::CommandLine& program) {
    program.command("bench", "Measure speed against error, back-ends beside each other, edits and displays.");
    return {"bench", [](std::string_view) {
                std::string name = "tessera", bench = "bench";
                char* words[] = {name.data(), bench.data(), nullptr};
                return start_bench(words);
            }};
}

}  // namespace tessera::tools

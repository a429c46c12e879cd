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
        return report_error("bench", cli::ExitUnavailable,
                            "'" + path + "' does not exist; deploy/setup.sh bench tessera-bench builds it");
    }
    return report_error("bench", cli::ExitUnavailable,
                        "cannot start '" + path + "': " + std::strerror(errno));
}

Command bench_command(cli::CommandLine& program) {
    program.command("bench", "Benchmarks: error over time, comparison of back-ends, edit latency, displays.");
    return {"bench", [](std::string_view) {
                std::string name = "tessera", bench = "bench";
                char* words[] = {name.data(), bench.data(), nullptr};
                return start_bench(words);
            }};
}

}  // namespace tessera::tools

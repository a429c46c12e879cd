#include <exception>
#include <iostream>
#include <vector>

#include "client/tools/bench.h"
#include "tests/bench/bench_command.h"

// Started by `tessera bench` with its arguments, or directly without the word `bench`.
int main(int argc, char** argv) {
    using namespace tessera;
    cli::CommandLine line("tessera", "Benchmarks of Tessera.");
    const tools::Command command = tools::bench::bench_command(line);
    std::vector<const char*> words(argv, argv + argc);
    if (!tools::names_bench(argc, argv)) words.insert(words.begin() + 1, "bench");
    if (const auto exit = line.parse(static_cast<int>(words.size()), words.data(), std::cout, std::cerr))
        return *exit;
    try {
        return command.run(line.chosen());
    } catch (const std::exception& error) {
        return tools::report_error("bench", tools::ExitInternal, error.what());
    }
}

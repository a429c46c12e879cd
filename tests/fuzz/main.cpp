// Fuzzes a cluster in this process. The same seed sends the same messages.
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "tests/fuzz/cluster_fuzz.h"
#include "tests/fuzz/virtual_time.h"

int main(int count, char** words) {
    // Freed memory that arenas of threads keep would count as used.
    mallopt(M_ARENA_MAX, 2);
    tessera::test::FuzzSettings settings;
    CLI::App app(
        "Sends valid messages of every role, in any order and with any values, to a master with honest nodes "
        "and clients, "
        "and checks that they are not harmed. Exit code 1: they were; the seed repeats the messages.");
    app.add_option("--seed", settings.seed, "of the messages")->capture_default_str();
    app.add_option("--messages", settings.messages, "to send at least")->capture_default_str();
    app.add_option("--peers", settings.peers, "that send them; every fourth has the same role")
        ->capture_default_str();
    bool real_time = false;
    app.add_flag(
        "--real-time", real_time,
        "wait for timeouts by the real clock; without, time stands still while any thread runs, and passes "
        "at once when none does");
    CLI11_PARSE(app, count, words);
    if (!real_time) tessera::test::begin_virtual_time();
    const tessera::test::FuzzReport report = tessera::test::fuzz_cluster(settings);
    const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
    std::printf(
        "seed %llu: %llu messages: %llu edits and %llu requests accepted, %llu frames, %llu units; "
        "%llu honest edits, %llu honest frames, %llu faults; %llu MiB of memory; a step of the loop took "
        "%.1f ms at most (%s); %.0f s of virtual time\n",
        number(settings.seed), number(report.messages), number(report.reached.edits),
        number(report.reached.requests), number(report.reached.frames), number(report.reached.units),
        number(report.edits), number(report.frames), number(report.faults), number(report.peak_memory >> 20),
        1e3 * report.longest_step_cpu, report.longest_part.c_str(),
        std::chrono::duration<double>(tessera::test::virtual_time()).count());
    for (const std::string& violation : report.violations) std::printf("violated: %s\n", violation.c_str());
    return report.violations.empty() ? 0 : 1;
}

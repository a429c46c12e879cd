#include "client/tools/doctor.h"

#include <sys/resource.h>

#include <memory>
#include <string>

#include "client/tools/diagnostics.h"
#include "client/tools/host_info.h"
#include "client/tools/vulkan_devices.h"
#include "mediator/backend/catalog.h"
#include "mediator/net/zmq_info.h"

namespace tessera::tools {

namespace {

std::string limit_text(rlim_t limit) {
    return limit == RLIM_INFINITY ? "unlimited" : std::to_string(limit);
}

void examine_processor(Diagnostics& diagnostics) {
    diagnostics.push_back(
        {Severity::Ok, "cores", std::to_string(core_count()) + " that this process may use", ""});
    std::string sets;
    const auto add = [&](bool present, const char* set) {
        sets += present ? std::string(sets.empty() ? "" : " ") + set : "";
    };
    add(__builtin_cpu_supports("sse4.2"), "sse4.2");
    add(__builtin_cpu_supports("avx2"), "avx2");
    add(__builtin_cpu_supports("fma"), "fma");
    add(__builtin_cpu_supports("avx512f"), "avx512f");
    add(__builtin_cpu_supports("avx512dq"), "avx512dq");
    add(__builtin_cpu_supports("avx512vl"), "avx512vl");
    const bool fits = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    diagnostics.push_back(
        {fits ? Severity::Ok : Severity::Error, "instruction sets", sets,
         fits ? "" : "Tessera is built for x86-64-v3 (AVX2 and FMA): use a processor of 2013 or later"});
}

void examine_backends(Diagnostics& diagnostics) {
    bool has_embree = false;
    for (const backend::BackendEntry& entry : backend::catalog()) {
        has_embree = has_embree || entry.name == "embree";
        try {
            const auto instance =
                entry.make({.threads = 1, .isa = {}, .blobs = std::make_shared<scene::BlobStore>()});
            diagnostics.push_back(
                {Severity::Ok, "back-end " + entry.name, instance->capabilities().kind, ""});
        } catch (const Error& error) {
            diagnostics.push_back({Severity::Error, "back-end " + entry.name, error.what(),
                                   "install libembree3-3 and start again"});
        }
    }
    if (!has_embree) {
        diagnostics.push_back({Severity::Warning, "back-end embree", "not built",
                               "install libembree-dev and configure with -DTESSERA_BACKEND_EMBREE=ON"});
    }
}

void examine_network(Diagnostics& diagnostics) {
    const net::ZmqInfo facts = net::zmq_info();
    diagnostics.push_back({facts.has_curve ? Severity::Ok : Severity::Error, "libzmq",
                           facts.version + (facts.has_curve ? " with CURVE" : " without CURVE"),
                           facts.has_curve ? "" : "install Debian's libzmq5, which is built with libsodium"});
}

void examine_limits(Diagnostics& diagnostics) {
    const std::uint64_t memory = total_memory_bytes();
    constexpr std::uint64_t Enough = 4ull << 30;
    diagnostics.push_back(
        {memory >= Enough ? Severity::Ok : Severity::Warning, "memory", byte_text(memory),
         memory >= Enough ? "" : "large scenes will not fit: use a machine with 4 GiB or more"});
    rlimit files{}, locked{};
    ::getrlimit(RLIMIT_NOFILE, &files);
    ::getrlimit(RLIMIT_MEMLOCK, &locked);
    constexpr rlim_t EnoughFiles = 4096;
    const bool plenty = files.rlim_cur >= EnoughFiles;
    diagnostics.push_back({plenty ? Severity::Ok : Severity::Warning, "open files",
                           limit_text(files.rlim_cur),
                           plenty ? "" : "a master of many nodes needs more: run ulimit -n 8192"});
    diagnostics.push_back({Severity::Ok, "locked memory", limit_text(locked.rlim_cur) + " bytes", ""});
}

struct DoctorOptions {
    bool json = false;
};

int run(const DoctorOptions& options) {
    Diagnostics diagnostics;
    examine_processor(diagnostics);
    examine_backends(diagnostics);
    examine_vulkan(diagnostics);
    examine_network(diagnostics);
    examine_limits(diagnostics);
    if (options.json) {
        print_json(diagnostics);
    } else {
        print(diagnostics);
    }
    for (const Diagnostic& diagnostic : diagnostics) {
        if (diagnostic.severity == Severity::Error) return cli::ExitUnavailable;
    }
    return 0;
}

}  // namespace

Command doctor_command(cli::CommandLine& program) {
    const auto options = std::make_shared<DoctorOptions>();
    cli::CommandLine& command = program.command(
        "doctor", "Check this machine's CPU, GPUs, libraries and limits, with a remedy for each problem.");
    command.flag("--json", "print a JSON list", options->json);
    command.examples({"tessera doctor"});
    return {"doctor", [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools

#include "client/tools/doctor.h"

#include <sys/resource.h>

#include <memory>
#include <string>

#include "client/tools/findings.h"
#include "client/tools/this_machine.h"
#include "client/tools/vulkan_devices.h"
#include "mediator/backend/catalog.h"
#include "mediator/net/zmq_facts.h"

namespace tessera::tools {

namespace {

std::string limit_text(rlim_t limit) {
    return limit == RLIM_INFINITY ? "unlimited" : std::to_string(limit);
}

void examine_processor(Findings& findings) {
    findings.push_back(
        {Verdict::Good, "cores", std::to_string(core_count()) + " that this process may use", ""});
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
    findings.push_back(
        {fits ? Verdict::Good : Verdict::Bad, "instruction sets", sets,
         fits ? "" : "Tessera is built for x86-64-v3 (AVX2 and FMA): use a processor of 2013 or later"});
}

void examine_backends(Findings& findings) {
    bool has_embree = false;
    for (const backend::BackendEntry& entry : backend::catalog()) {
        has_embree = has_embree || entry.name == "embree";
        try {
            const auto made =
                entry.make({.threads = 1, .isa = {}, .blobs = std::make_shared<scene::BlobStore>()});
            findings.push_back({Verdict::Good, "back-end " + entry.name, made->capabilities().kind, ""});
        } catch (const Error& error) {
            findings.push_back({Verdict::Bad, "back-end " + entry.name, error.what(),
                                "install libembree3-3 and start again"});
        }
    }
    if (!has_embree) {
        findings.push_back({Verdict::Poor, "back-end embree", "not built",
                            "install libembree-dev and configure with -DTESSERA_BACKEND_EMBREE=ON"});
    }
}

void examine_network(Findings& findings) {
    const net::ZmqFacts facts = net::zmq_facts();
    findings.push_back({facts.has_curve ? Verdict::Good : Verdict::Bad, "libzmq",
                        facts.version + (facts.has_curve ? " with CURVE" : " without CURVE"),
                        facts.has_curve ? "" : "install Debian's libzmq5, which is built with libsodium"});
}

void examine_limits(Findings& findings) {
    const std::uint64_t memory = total_memory_bytes();
    constexpr std::uint64_t Enough = 4ull << 30;
    findings.push_back(
        {memory >= Enough ? Verdict::Good : Verdict::Poor, "memory", byte_text(memory),
         memory >= Enough ? "" : "large scenes will not fit: use a machine with 4 GiB or more"});
    rlimit files{}, locked{};
    ::getrlimit(RLIMIT_NOFILE, &files);
    ::getrlimit(RLIMIT_MEMLOCK, &locked);
    constexpr rlim_t EnoughFiles = 4096;
    const bool plenty = files.rlim_cur >= EnoughFiles;
    findings.push_back({plenty ? Verdict::Good : Verdict::Poor, "open files", limit_text(files.rlim_cur),
                        plenty ? "" : "a master of many nodes needs more: ulimit -n 8192"});
    findings.push_back({Verdict::Good, "locked memory", limit_text(locked.rlim_cur) + " bytes", ""});
}

struct DoctorOptions {
    bool json = false;
};

int run(const DoctorOptions& options) {
    Findings findings;
    examine_processor(findings);
    examine_backends(findings);
    examine_vulkan(findings);
    examine_network(findings);
    examine_limits(findings);
    if (options.json) {
        print_json(findings);
    } else {
        print(findings);
    }
    for (const Finding& finding : findings) {
        if (finding.verdict == Verdict::Bad) return cli::ExitUnavailable;
    }
    return 0;
}

}  // namespace

Command doctor_command(cli::CommandLine& program) {
    const auto options = std::make_shared<DoctorOptions>();
    cli::CommandLine& command = program.command(
        "doctor", "Tell what this machine offers to Tessera, with remedies for what is missing.");
    command.flag("--json", "print a JSON list", options->json);
    command.examples({"tessera doctor"});
    return {"doctor", [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools

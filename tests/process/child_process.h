#pragma once

#include "client/tools/child_process.h"

namespace tessera::test {

// A program of the build's bin folder.
struct ChildProcess : tools::ChildProcess {
    ChildProcess(const std::filesystem::path& folder, const std::string& label, const std::string& program,
                 const std::vector<std::string>& arguments)
        : tools::ChildProcess(folder, label, std::filesystem::path(TESSERA_BIN) / program, arguments) {}
};

using tools::free_loopback_endpoint;

}  // namespace tessera::test

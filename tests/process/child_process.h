#pragma once

#include "client/tools/child_process.h"
#include "tests/support/folders.h"

namespace tessera::test {

// A program of the build's bin folder.
struct ChildProcess : tools::ChildProcess {
    ChildProcess(const std::filesystem::path& folder, const std::string& label, const std::string& program,
                 const std::vector<std::string>& arguments)
        : tools::ChildProcess(folder, label, test::programs_folder() / program, arguments) {}
};

using tools::free_loopback_endpoint;

}  // namespace tessera::test

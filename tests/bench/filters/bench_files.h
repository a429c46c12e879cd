#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/filters/results.h"

namespace tessera::tools::bench {

// The folder of the reports: filters.html, filters.json, crops.png and crops.md.
class BenchFiles {
  public:
    explicit BenchFiles(std::filesystem::path folder);  // created if needed; throws Error{Io}

    // Writes each file atomically. Returns the paths. Throws Error{Io}.
    std::vector<std::string> write(const BenchResults& results) const;

  private:
    std::filesystem::path folder_;
};

}  // namespace tessera::tools::bench

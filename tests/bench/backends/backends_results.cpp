#include "tests/bench/backends/backends_results.h"

#include <algorithm>

namespace tessera::tools::bench {

const std::vector<double>& Measurements::all(std::string_view key) const {
    static const std::vector<double> none;
    const auto found = values_.find(std::string(key));
    return found == values_.end() ? none : found->second;
}

double Measurements::median(std::string_view key) const {
    std::vector<double> sorted = all(key);
    if (sorted.empty()) return 0.0;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t center = sorted.size() / 2;
    return sorted.size() % 2 == 1 ? sorted[center] : 0.5 * (sorted[center - 1] + sorted[center]);
}

}  // namespace tessera::tools::bench

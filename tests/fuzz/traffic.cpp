#include "tests/fuzz/traffic.h"

namespace tessera::test {

void Traffic::sent(std::string_view kind) {
    ++total_;
    const auto known = counts_.find(kind);
    if (known == counts_.end()) {
        counts_.emplace(kind, 1);
    } else {
        ++known->second;
    }
}

std::size_t Traffic::rarest(const std::vector<std::string_view>& kinds) const {
    std::size_t rarest = 0;
    for (std::size_t i = 1; i < kinds.size(); ++i) {
        if (share(kinds[i]) < share(kinds[rarest])) rarest = i;
    }
    return rarest;
}

double Traffic::share(std::string_view kind) const {
    const auto known = counts_.find(kind);
    return known == counts_.end() ? 0.0 : static_cast<double>(known->second) / static_cast<double>(total_);
}

}  // namespace tessera::test

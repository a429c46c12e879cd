#include "master/render/percentiles.h"

#include <algorithm>
#include <vector>

namespace tessera::master {

void Percentiles::add(Duration duration) {
    latest_.push_back(duration);
    if (latest_.size() > Length) latest_.pop_front();
    ++count_;
}

session::StageTimes Percentiles::summary(const std::string& name) const {
    session::StageTimes times{.name = name, .count = count_};
    if (latest_.empty()) return times;
    std::vector<Duration> sorted(latest_.begin(), latest_.end());
    std::sort(sorted.begin(), sorted.end());
    const auto rank = [&](double part) {
        const auto index = static_cast<std::size_t>(part * double(sorted.size() - 1) + 0.5);
        return seconds(sorted[index]);
    };
    times.p50_seconds = rank(0.5);
    times.p99_seconds = rank(0.99);
    return times;
}

}  // namespace tessera::master

#include "master/render/schedule/balancer.h"

#include <algorithm>

namespace tessera::master {

void Balancer::measured(NodeId node, std::uint64_t samples, Duration busy) {
    const double time = seconds(busy);
    if (samples == 0 || time <= 0.0) return;
    const double rate = static_cast<double>(samples) / time;
    const auto [it, fresh] = rates_.try_emplace(node, rate);
    if (!fresh) it->second += settings_.smoothing * (rate - it->second);
}

double Balancer::rate(NodeId node) const {
    const auto it = rates_.find(node);
    return it == rates_.end() ? 0.0 : it->second;
}

double Balancer::assumed_rate(NodeId node) const {
    const double measured_rate = rate(node);
    return measured_rate > 0.0 ? measured_rate : settings_.first_samples / settings_.unit_seconds;
}

std::uint64_t Balancer::unit_samples(NodeId node, std::uint64_t remaining, std::uint32_t workers) const {
    const double measured_rate = rate(node);
    const double wanted =
        measured_rate > 0.0 ? measured_rate * settings_.unit_seconds : settings_.first_samples;
    const double fair = static_cast<double>(remaining) / (2.0 * std::max(workers, 1u));
    return static_cast<std::uint64_t>(std::max(1.0, std::min(wanted, fair)));
}

}  // namespace tessera::master

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

std::uint64_t Balancer::unit_samples(NodeId node, double left) const {
    const double time = std::min(settings_.unit_seconds, 0.5 * left);
    return static_cast<std::uint64_t>(std::max(1.0, assumed_rate(node) * time));
}

}  // namespace tessera::master

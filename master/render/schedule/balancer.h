#pragma once

#include <cstdint>
#include <map>

#include "mediator/base/clock.h"
#include "mediator/base/ids.h"

namespace tessera::master {

// Measures the speed of each node and chooses the size of its next unit. Pure.
class Balancer {
  public:
    struct Settings {
        double unit_seconds = 0.1;    // what one unit should take one worker
        double first_samples = 4096;  // a unit for a node without a measurement
        double smoothing = 0.3;       // weight of the newest measurement
    };
    Balancer() = default;
    explicit Balancer(const Settings& settings) : settings_(settings) {}

    // A unit of `samples` pixel samples kept one worker busy for `busy`.
    void measured(NodeId node, std::uint64_t samples, Duration busy);
    void forget(NodeId node) { rates_.erase(node); }

    double rate(NodeId node) const;          // pixel samples per second of one worker; 0 = not measured
    double assumed_rate(NodeId node) const;  // the same; not measured: that of a first unit in `unit_seconds`
    double unit_seconds() const { return settings_.unit_seconds; }

    // Pixel samples for the node's next unit. Shrinks when all nodes together need no more than `left` s for what has
    // not been dealt, so that all finish together: it takes half of that at most.
    std::uint64_t unit_samples(NodeId node, double left) const;

  private:
    Settings settings_;
    std::map<NodeId, double> rates_;
};

}  // namespace tessera::master

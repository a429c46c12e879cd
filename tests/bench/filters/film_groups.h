#pragma once

#include <map>

#include "tests/bench/filters/plan.h"
#include "tests/bench/filters/sampler.h"

namespace tessera::tools::bench {

// Filters that use the same film: one path class, with the union of their channels. Films of different groups
// have the same samples.
struct FilmGroup {
    view::PathClass path_class = view::PathClass::Indirect;
    frame::ChannelSet channels;
    std::vector<std::size_t> filters;  // indices into the plan's
};

std::vector<FilmGroup> film_groups(const std::vector<filter::Choice>& filters);

// Seconds per sample of a view that has these channels, measured on a small film, once for each combination.
class SamplingCost {
  public:
    SamplingCost(const Sampler& sampler, Size size) : sampler_(sampler), size_(size) {}
    double of(frame::ChannelSet channels, view::PathClass path_class, const std::stop_token& stop);

  private:
    const Sampler& sampler_;
    Size size_;
    std::map<std::pair<frame::ChannelSet::Words, view::PathClass>, double> known_;
};

}  // namespace tessera::tools::bench

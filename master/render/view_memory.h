#pragma once

#include <cstdint>
#include <set>
#include <string_view>
#include <tuple>

#include "mediator/session/view_request.h"

namespace tessera::master {

// Memory of the master that a set of views takes: their films, and what their denoisers keep between pictures. Some
// denoisers keep it for each view and each of its coarse pictures (filter::Description::needs_own_instance()); of the
// others, views of one size share an instance.
class ViewMemory {
  public:
    // `request.view` is complete (master/render/view_request.h).
    void add(const session::ViewRequest& request);
    std::uint64_t bytes() const { return bytes_ + decision_; }

  private:
    std::uint64_t bytes_ = 0;
    std::uint64_t decision_ = 0;  // the largest one: the steps of all views are decided one after another
    std::set<std::tuple<std::string_view, std::int32_t, std::int32_t>> shared_;  // name, width, height
};

}  // namespace tessera::master

#pragma once

#include <memory>

#include "mediator/filter/choice.h"
#include "tests/bench/filters/results.h"

namespace tessera::tools::bench {

// Bytes per second, read and written, of copying `bytes` from one array to another on all threads of the
// arena; the best of several.
double copy_bandwidth(std::size_t bytes, tbb::task_arena& arena);

// One filter with its parameter values at one size.
class FilterRun {
  public:
    FilterRun(const filter::Choice& choice, std::uint32_t width, std::uint32_t height,
              tbb::task_arena& arena);

    // r, g, b, without a history. Throws Error{Internal} when the picture is not finite.
    frame::Image picture(const filter::Inputs& inputs, std::vector<std::string>* notes = nullptr);
    frame::Image next_picture(
        const filter::Inputs& inputs);  // of a path: with the history of the ones before

    // After picture(), so that nothing is allocated; without a history.
    FilterTime time(const filter::Inputs& inputs, double copy_bytes_per_second);

  private:
    filter::Choice choice_;
    tbb::task_arena& arena_;
    std::unique_ptr<filter::Filter> filter_;
    filter::Output output_;
};

}  // namespace tessera::tools::bench
